#include "tools/rt-import/import_options.h"

#include "common/error.h"
#include "tools/rt-import/model_formats.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/scene_description.h"
#include "tools/rt-import/smooth_normals.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>

namespace rt {
namespace {

constexpr double kMaxSeconds = 1e6;

void declareFiles(CLI::App& app, ImportOptions& options) {
    app.add_option(
           "INPUT", options.sources.inputs,
           "Models and scene files (*.scene.json), merged in this order; not standard input: textures are "
           "looked for beside them")
        ->type_name("FILE");
    app.add_option(
           "--texture-root", options.sources.roots,
           "Another folder, repeatable, in which the files that inputs name may lie: textures, and models "
           "and environments of scene files")
        ->allow_extra_args(false)
        ->type_name("DIR");
    app.add_option("-o,--output", options.outputPath, "Mesh to write; - for standard output")
        ->type_name("FILE");
    app.add_option("--allow-format", options.settings.allowedFormats,
                   "Read files of this extension too, by a loader of Assimp's that is not among the usual "
                   "ones; may be repeated")
        ->type_name("EXTENSION")
        ->allow_extra_args(false);
    app.add_flag("--list-formats", options.listFormats,
                 "Print the extensions that are read, and those that --allow-format adds");
}

void declareRepair(CLI::App& app, ImportOptions& options) {
    RepairOptions& repair = options.settings.repair;
    app.add_option("--weld", repair.weldDistance,
                   "Make one of vertices that are this close, in units of the scene; equal ones always are")
        ->check(numberBetween(0.0, 1e30))
        ->capture_default_str()
        ->type_name("DISTANCE");
    app.add_option(
           "--crease", repair.creaseDegrees,
           "Angle from which generated normals keep an edge sharp; given, it also smooths 3DS files without "
           "smoothing groups, which are flat")
        ->check(numberBetween(0.0, 180.0))
        ->default_str(fmt::format("{:g}", kUsualCrease))
        ->type_name("DEG");
    app.add_option(
           "--decimate", repair.decimateRatio,
           "Keep this part of the triangles, or what can be had: those go first whose loss changes the "
           "shape least. Normals are made anew")
        ->check(numberBetween(0.0, 1.0))
        ->type_name("RATIO");
    app.add_option("--max-triangles", repair.maxTriangles,
                   fmt::format("Decimate what has more triangles, and refuse what cannot be brought down to "
                               "that; files of more than {} are refused in any case",
                               kMaxSoupCount))
        ->check(numberBetween(1.0, static_cast<double>(kMaxSoupCount)))
        ->type_name("N");
    app.add_flag("--strict", options.settings.strict,
                 "Refuse a model of which anything has to be repaired or cannot be carried over");
}

void declareLimits(CLI::App& app, ImportOptions& options, std::string& maxMemory) {
    const MemoryLimit most = defaultMemoryLimit();
    app.add_option(
           "--max-memory", maxMemory,
           fmt::format("Memory that reading may take, e.g. 800M or 12G: bytes, or with K, M, G or T "
                       "multiples of 1024; by default the larger of 2G and {} times the model's file, "
                       "but no more than {}, {}M",
                       kMemoryPerByte, most.origin, most.bytes >> 20))
        ->type_name("SIZE");
    app.add_option("--max-time", options.limits.seconds, "Seconds that reading may take")
        ->check(numberBetween(0.001, kMaxSeconds))
        ->capture_default_str()
        ->type_name("S");
}

// Of all of them. What scene files name is not known yet and may be anything.
std::uint64_t fileBytes(const std::vector<std::string>& paths) {
    std::uint64_t sum = 0;
    for (const std::string& path : paths) {
        if (isSceneFile(path)) return std::numeric_limits<std::uint64_t>::max();
        std::error_code unknown; // reading it will say why
        const std::uint64_t bytes = std::filesystem::file_size(path, unknown);
        sum += unknown ? 0 : bytes;
    }
    return sum;
}

void checkSources(const SceneSources& sources) {
    if (std::find(sources.inputs.begin(), sources.inputs.end(), "-") != sources.inputs.end())
        throw Error(ErrorKind::Usage,
                    "-: a model cannot come from standard input, since its textures are looked "
                    "for in its folder; name a file (./- for one called -)");
    for (const std::string& root : sources.roots)
        if (!std::filesystem::is_directory(root))
            throw Error(ErrorKind::FileAccess, fmt::format("--texture-root {}: is no folder", root));
}

void requireSound(const ImportOptions& options) {
    const RepairOptions& repair = options.settings.repair;
    for (const auto& [name, value] : {std::pair("--crease", repair.creaseDegrees.value_or(kUsualCrease)),
                                      {"--weld", repair.weldDistance},
                                      {"--decimate", repair.decimateRatio},
                                      {"--max-time", options.limits.seconds}})
        if (std::isnan(value)) throw Error(ErrorKind::Usage, fmt::format("{}: nan is no such number", name));
    if (repair.decimateRatio == 0.0)
        throw Error(ErrorKind::Usage, "--decimate: 0 would leave nothing; give a part such as 0.25");
    if (options.sources.inputs.empty() || options.outputPath.empty())
        throw Error(ErrorKind::Usage, "an INPUT and -o FILE are required; see rt-import --help");
    checkSources(options.sources);
    checkBuildOptions(options.common, options.sources.inputs, outputsOf(options));
    for (const std::string& extension : options.settings.allowedFormats) requireKnownFormat(extension);
    requireDistinctPaths(options.sources.inputs, outputsOf(options));
}

// The inputs, which may be links, their folders, and the roots.
std::vector<std::string> readablePlaces(const SceneSources& sources) {
    std::vector<std::string> places = sources.roots;
    for (const std::string& input : sources.inputs) {
        const std::string folder = std::filesystem::path(input).parent_path();
        places.push_back(input);
        places.push_back(folder.empty() ? "." : folder);
    }
    return places;
}

} // namespace

bool parseImportOptions(int argc, const char* const* argv, ImportOptions& options) {
    CLI::App app("Reads models (" + readableFormats() + ") and scene files (*.scene.json) into one .rtmesh",
                 "rt-import");
    std::string maxMemory;
    declareFiles(app, options);
    declareRepair(app, options);
    declareLimits(app, options, maxMemory);
    addCommonOptions(app, options.common,
                     fmt::format("{}, {}, stb_image", assimpVersion(), openMeshVersion()));
    addBuildOptions(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return false;
    if (options.listFormats) return true;
    options.common.making =
        makingOf(app, options.common, {"INPUT", "--texture-root", "--max-memory", "--max-time"});
    requireSound(options);
    options.limits.readable = readablePlaces(options.sources);
    options.limits.memory = maxMemory.empty()
                                ? readingMemoryLimit(fileBytes(options.sources.inputs))
                                : MemoryLimit{parseByteSize(maxMemory, "--max-memory"), "--max-memory"};
    return true;
}

std::vector<std::string> outputsOf(const ImportOptions& options) {
    std::vector<std::string> paths{options.outputPath};
    for (const std::string& path : {options.common.jsonPath, options.common.depfilePath})
        if (!path.empty()) paths.push_back(path);
    return paths;
}

} // namespace rt
