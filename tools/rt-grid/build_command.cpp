#include "tools/rt-grid/build_command.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/progress.h"
#include "formats/atlas_file.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-grid/forecast_build.h"
#include "tools/rt-grid/forecast_report.h"
#include "tools/rt-grid/options.h"
#include "tools/rt-grid/report.h"
#include "tools/rt-grid/vdb_export.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <optional>

namespace rt {
namespace {

void build(const GridOptions& options, const Recipe& recipe) {
    StageTimer timer;
    std::optional<StageProgress> progress(timer);
    timer.begin("read");
    const MeshFile mesh = readMesh(options.meshPath);
    const auto [atlas, choice] = buildAtlas(mesh, options.meshPath, options.build, timer);
    std::string vdb;
    if (!options.vdbPath.empty()) {
        timer.begin("vdb");
        vdb = vdbBytes(atlas, recipe);
    }
    timer.begin("write");
    writeAtlas(options.atlasPath, atlas, recipe);
    if (!options.vdbPath.empty()) writeFile(options.vdbPath, vdb);
    timer.end();
    progress.reset();
    const GridReport report{options, atlas, choice, timer};
    if (!options.common.jsonPath.empty()) writeReport(options.common.jsonPath, jsonOf(report), recipe);
    logInfo(summaryOf(report));
    logStages(timer);
}

void forecast(const GridOptions& options) {
    const std::uint64_t programBytes = peakMemoryBytes();
    StageTimer timer;
    std::optional<StageProgress> progress(timer);
    timer.begin("read");
    const MeshFile mesh = readMesh(options.meshPath);
    ForecastReport report{options,
                          forecastBuild(mesh, options.meshPath, options.build, timer),
                          programBytes,
                          fileBytesOf(mesh.mesh),
                          {guaranteedLimits()}};
    if (auto device = limitsOfThisDevice()) report.devices.push_back(std::move(*device));
    progress.reset();
    const std::string& jsonPath = options.common.jsonPath;
    if (!options.common.quiet && jsonPath != "-") std::fputs(textOf(report).c_str(), stdout);
    if (!jsonPath.empty()) writeJson(jsonPath, jsonOf(report));
    logStages(timer);
    if (!report.forecast.refusal.empty()) throw Error(ErrorKind::LimitExceeded, report.forecast.refusal);
}

} // namespace

int buildCommand(int argc, const char* const* argv) {
    const std::optional<GridOptions> options = parseGridOptions(argc, argv);
    if (!options) return 0;
    for (const std::string& path : outputsOf(*options)) requireWritable(path);
    if (options->dryRun) {
        forecast(*options);
        return 0;
    }
    const Recipe recipe = recipeOf(options->common.making, {{"mesh", contentIdOf(options->meshPath)}});
    const auto isMade = [&](const std::string& output) { return carries(output, recipe); };
    if (!isUpToDate(options->common, outputsOf(*options), isMade)) build(*options, recipe);
    writeDependencies(options->common, outputsOf(*options), {options->meshPath});
    return 0;
}

} // namespace rt
