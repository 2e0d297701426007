#include "tools/rt-import/import_options.h"

#include "common/error.h"
#include "tools/rt-import/open_model.h"
#include "tools/rt-import/repair_mesh.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace rt {
namespace {

void checkSources(const SceneSources& sources) {
    if (std::find(sources.inputs.begin(), sources.inputs.end(), "-") != sources.inputs.end())
        throw Error(ErrorKind::Usage,
                    "-: a model cannot come from standard input, since its textures are looked "
                    "for in its folder; name a file (./- for one called -)");
    for (const std::string& root : sources.roots)
        if (!std::filesystem::is_directory(root))
            throw Error(ErrorKind::FileAccess, fmt::format("--texture-root {}: is no folder", root));
}

} // namespace

bool parseImportOptions(int argc, const char* const* argv, ImportOptions& options) {
    CLI::App app("Reads models (" + readableFormats() + ") and scene files (*.scene.json) into one .rtmesh",
                 "rt-import");
    app.add_option(
           "INPUT", options.sources.inputs,
           "Models and scene files (*.scene.json), merged in this order; not standard input: textures are "
           "looked for beside them")
        ->required()
        ->type_name("FILE");
    app.add_option(
           "--texture-root", options.sources.roots,
           "Another folder, repeatable, in which the files that inputs name may lie: textures, and models "
           "and environments of scene files")
        ->allow_extra_args(false)
        ->type_name("DIR");
    app.add_option("-o,--output", options.outputPath, "Mesh to write; - for standard output")
        ->required()
        ->type_name("FILE");
    app.add_option("--crease", options.creaseDegrees, "Angle from which generated normals keep an edge sharp")
        ->check(numberBetween(0.0, 180.0))
        ->capture_default_str()
        ->type_name("DEG");
    addCommonOptions(app, options.common,
                     fmt::format("{}, {}, stb_image", assimpVersion(), openMeshVersion()));
    addDepfileOption(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return false;

    if (std::isnan(options.creaseDegrees)) throw Error(ErrorKind::Usage, "--crease: nan is not an angle");
    checkSources(options.sources);
    if (options.outputPath == "-" && !options.common.depfilePath.empty())
        throw Error(ErrorKind::Usage, "--depfile needs an output file to speak of; -o is -");
    requireDistinctPaths(options.sources.inputs, outputsOf(options));
    return true;
}

std::vector<std::string> outputsOf(const ImportOptions& options) {
    std::vector<std::string> paths{options.outputPath};
    for (const std::string& path : {options.common.jsonPath, options.common.depfilePath})
        if (!path.empty()) paths.push_back(path);
    return paths;
}

} // namespace rt
