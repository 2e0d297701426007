#include "tools/rt-grid/options.h"

#include "common/error.h"
#include "tools/rt-grid/libraries.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

namespace rt {
namespace {

constexpr const char* kAuto = "auto";
constexpr std::array kQualities{"fast", "balanced", "best"}; // as the enumerators of Quality

// Options as they are typed; readRaw() turns them into BuildOptions.
struct RawOptions {
    std::string structure = kAuto;
    std::string quality = "balanced";
    std::string resolution;
    double density = 0.0;
    std::optional<unsigned> leafSize;
    std::string maxMemory;
};

const char* const kDescription =
    "Builds the acceleration structure of a .rtmesh and writes it, with all that rendering needs, as a "
    ".rtatlas.\n"
    "The defaults suit all scenes that were measured. Touch --quality to trade memory and build time for "
    "speed; the other\n"
    "options below are for experiments, or where a scene does not fit into memory.\n"
    "Other commands: rt-grid verify --help (proves an atlas), rt-grid inspect --help (shows what is in one).";

void declareDensity(CLI::App& app, RawOptions& raw) {
    auto* resolution =
        app.add_option("--resolution", raw.resolution,
                       fmt::format("N voxels along the longest side and cubic voxels (at least 1 on every "
                                   "axis), or exactly X by Y by Z; up to {} on an axis, 2^29 in all",
                                   kMaxRequestedSide))
            ->type_name("N|XxYxZ");
    const QualityPreset preset = presetOf(Quality::balanced);
    app.add_option(
           "--density", raw.density,
           fmt::format(
               "Voxels per triangle, when there is no --resolution; if not given, {} for "
               "uniform, {} for cloud and octant and {} for nested, bricks not counted. At most "
               "{} on an axis and 2^28 in all are made of it. Raise it where reports show many tests per ray",
               preset.uniformVoxelsPerTriangle, preset.cloudVoxelsPerTriangle, preset.nestedVoxelsPerTriangle,
               kMaxAutomaticSide))
        ->check(numberBetween(1e-6, 1e9))
        ->excludes(resolution)
        ->type_name("D");
    app.add_option(
           "--leaf-size", raw.leafSize,
           fmt::format(
               "For nested and auto: triangles that a voxel of a brick may list before it may become a brick "
               "itself; {} if not given, {} for best. Lower it for fewer triangle tests and more memory",
               preset.nest.leafSize, presetOf(Quality::best).nest.leafSize))
        ->check(numberBetween(1, 1000000))
        ->type_name("N");
}

void declare(CLI::App& app, GridOptions& options, RawOptions& raw) {
    const MemoryLimit memory = defaultMemoryLimit();
    app.add_option("mesh", options.meshPath, "Input; - for standard input")
        ->required()
        ->type_name("scene.rtmesh");
    app.add_option("-o,--output", options.atlasPath,
                   "Output; - for standard output; not needed with --dry-run")
        ->type_name("scene.rtatlas");
    app.add_flag(
        "--dry-run", options.dryRun,
        "Build and write nothing: say how many voxels, bytes and what memory it would take, and how that "
        "fits GPUs");
    app.add_option("--structure", raw.structure,
                   "auto (default): nested or octant, whichever should cost a ray less; nested: crowded "
                   "voxels hold finer ones; octant: empty voxels know how far rays may leap to each side; "
                   "cloud: they know one distance for all sides; uniform: plain grid, for comparisons")
        ->check(CLI::IsMember({kAuto, "uniform", "cloud", "octant", "nested"}).description(""))
        ->type_name("auto|uniform|cloud|octant|nested");
    app.add_option(
           "--quality", raw.quality,
           "balanced (default); best: about a fifth more diffuse rays per second for twice to three times "
           "the memory and build time; fast: the smallest file and shortest build")
        ->check(CLI::IsMember({kQualities[0], kQualities[1], kQualities[2]}).description(""))
        ->type_name("fast|balanced|best");
    declareDensity(app, raw);
    app.add_option(
           "--max-memory", raw.maxMemory,
           fmt::format(
               "Refuse builds that need more, e.g. 800M or 12G: bytes, or with K, M, G or T multiples of "
               "1024; by default {}, {}M. Raise it only if you mean to swap",
               memory.origin, memory.bytes >> 20))
        ->type_name("SIZE");
    app.add_option("--vdb", options.vdbPath,
                   "Write the voxels as OpenVDB grids too: to look at a grid in other programs")
        ->type_name("out.vdb");
}

void readRaw(const RawOptions& raw, GridOptions& options) {
    BuildOptions& build = options.build;
    for (const std::uint32_t kind : {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested})
        if (raw.structure == structureName(kind)) build.structure = kind;
    build.quality = static_cast<Quality>(std::find(kQualities.begin(), kQualities.end(), raw.quality) -
                                         kQualities.begin());
    build.resolution.voxelsPerTriangle = raw.density;
    if (raw.leafSize) {
        if (build.structure && build.structure != kStructureNested)
            throw Error(ErrorKind::Usage,
                        fmt::format("--leaf-size goes with --structure nested or auto; {} has no bricks",
                                    raw.structure));
        build.nest = presetOf(build.quality).nest;
        build.nest->leafSize = *raw.leafSize;
    }
    if (!raw.resolution.empty()) parseResolution(raw.resolution, build.resolution);
    if (!raw.maxMemory.empty()) build.memory = {parseByteSize(raw.maxMemory, "--max-memory"), "--max-memory"};
    build.vdb = !options.vdbPath.empty();
    if (options.atlasPath.empty() && !options.dryRun)
        throw Error(ErrorKind::Usage, "--output is required; see rt-grid --help");
    if (options.dryRun && (options.common.ifChanged || !options.common.depfilePath.empty()))
        throw Error(ErrorKind::Usage, "--if-changed and --depfile need an output; --dry-run builds none");
}

} // namespace

std::optional<GridOptions> parseGridOptions(int argc, const char* const* argv) {
    GridOptions options;
    RawOptions raw;
    CLI::App app(kDescription, "rt-grid");
    declare(app, options, raw);
    addCommonOptions(app, options.common, gridLibraries());
    addBuildOptions(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    readRaw(raw, options);
    options.common.making = makingOf(app, options.common, {"mesh", "--vdb"});
    if (options.build.vdb) options.common.making += "\nvdb"; // whose memory counts
    requireDistinctPaths({options.meshPath}, outputsOf(options));
    checkBuildOptions(options.common, {options.meshPath}, outputsOf(options));
    return options;
}

std::vector<std::string> outputsOf(const GridOptions& options) {
    std::vector<std::string> paths;
    if (!options.dryRun) paths = {options.atlasPath, options.vdbPath};
    paths.insert(paths.end(), {options.common.jsonPath, options.common.depfilePath});
    std::erase(paths, "");
    return paths;
}

void parseResolution(const std::string& text, ResolutionRequest& request) {
    if (text.find('x') == std::string::npos) {
        request.longestSide = parseSizes(text, 1, "--resolution")[0];
    } else {
        const std::vector<unsigned> sizes = parseSizes(text, 3, "--resolution");
        request.exact = glm::uvec3(sizes[0], sizes[1], sizes[2]);
    }
}

} // namespace rt
