#include "tools/rt-grid/inspect_command.h"

#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/progress.h"
#include "common/stage_timer.h"
#include "tools/rt-grid/inspect_report.h"
#include "tools/rt-grid/libraries.h"
#include "tools/rt-grid/slices.h"
#include "tools/rt-grid/vdb_export.h"
#include "tools/rt-grid/write_files.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <optional>

namespace rt {
namespace {

const char* const kDescription = "Shows what is in a .rtatlas: its levels and bricks, how full they are, how "
                                 "far rays may leap, how long lists are,\n"
                                 "what each section takes and how it fits GPUs, and what rays have to do. "
                                 "Pictures and OpenVDB grids on request.";

struct InspectOptions {
    std::string atlasPath;
    std::string slicesFolder; ///< empty: none
    std::string vdbPath;      ///< empty: none
    glm::dvec3 sliceAt{0.5};
    CommonOptions common;
};

std::optional<InspectOptions> parse(int argc, const char* const* argv) {
    InspectOptions options;
    std::string sliceAt;
    CLI::App app(kDescription, "rt-grid inspect");
    app.add_option("atlas", options.atlasPath, "Input; - for standard input")
        ->required()
        ->type_name("scene.rtatlas");
    auto* slices =
        app.add_option("--slices", options.slicesFolder,
                       "Write PNG pictures of cuts across x, y and z into this folder, which is made if "
                       "it is not there: occupancy, distance and references, with legends")
            ->type_name("DIR");
    app.add_option("--slice-at", sliceAt,
                   "Where to cut, as parts of the grid from 0 to 1; 0.5,0.5,0.5 if not given")
        ->needs(slices)
        ->type_name("X,Y,Z");
    app.add_option("--vdb", options.vdbPath,
                   "Write occupancy, distances and references of each level as OpenVDB grids in world space")
        ->type_name("out.vdb");
    addCommonOptions(app, options.common, gridLibraries());
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    if (!sliceAt.empty()) {
        const std::vector<double> parts = parseNumbers(sliceAt, 3, "--slice-at");
        for (const double part : parts)
            if (part < 0.0 || part > 1.0)
                throw Error(ErrorKind::Usage, fmt::format("--slice-at: {} is not between 0 and 1", part));
        options.sliceAt = {parts[0], parts[1], parts[2]};
    }
    requireDistinctPaths({options.atlasPath}, {options.vdbPath, options.common.jsonPath});
    return options;
}

} // namespace

int inspectCommand(int argc, const char* const* argv) {
    const std::optional<InspectOptions> options = parse(argc, argv);
    if (!options) return 0;
    const std::string& jsonPath = options->common.jsonPath;
    for (const std::string& path : {options->vdbPath, jsonPath})
        if (!path.empty()) requireWritable(path);
    if (!options->slicesFolder.empty()) requireFolderWritable(options->slicesFolder);
    StageTimer timer;
    std::optional<StageProgress> progress(timer);
    timer.begin("read");
    const AtlasFile file = readAtlas(options->atlasPath);
    timer.begin("figures");
    InspectReport report{options->atlasPath, file, figuresOf(file.atlas), {}, {guaranteedLimits()}};
    timer.begin("rays");
    report.rays = walkRays(file.atlas);
    timer.begin("device");
    if (auto device = limitsOfThisDevice()) report.devices.push_back(std::move(*device));
    if (!options->slicesFolder.empty()) {
        timer.begin("slices");
        std::vector<NamedBytes> files;
        for (const SlicePicture& slice : slicesOf(file.atlas, options->sliceAt))
            files.push_back({slice.name, encodeImage(slice.name, slice.image)});
        writeFolder(options->slicesFolder, files);
    }
    if (!options->vdbPath.empty()) {
        timer.begin("vdb");
        writeFile(options->vdbPath, vdbBytes(file.atlas));
    }
    timer.end();
    progress.reset();
    if (!options->common.quiet && jsonPath != "-" && options->vdbPath != "-")
        std::fputs(textOf(report).c_str(), stdout);
    if (!jsonPath.empty()) writeJson(jsonPath, jsonOf(report));
    logStages(timer);
    return 0;
}

} // namespace rt
