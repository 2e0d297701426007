#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "formats/atlas_file.h"
#include "tools/rt-grid/report.h"
#include "tools/rt-grid/vdb_export.h"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

namespace rt {
namespace {

void logStages(const StageTimer& timer) {
    for (const auto& [stage, ms] : timer.stagesMs()) logDetail(fmt::format("{:<10}{:9.1f} ms", stage, ms));
    logDetail(fmt::format("largest memory {} MiB", peakMemoryBytes() >> 20));
}

int gridMain(int argc, const char* const* argv) {
    const std::optional<GridOptions> options = parseGridOptions(argc, argv);
    if (!options) return 0;
    StageTimer timer;
    timer.begin("read");
    const MeshFile mesh = readMesh(options->meshPath);
    const Atlas atlas = buildAtlas(mesh, options->meshPath, options->build, timer);
    if (!options->vdbPath.empty()) {
        timer.begin("vdb");
        writeFile(options->vdbPath, vdbBytes(atlas));
    }
    timer.begin("write");
    writeAtlas(options->atlasPath, atlas);
    timer.end();
    const GridReport report{*options, atlas, timer};
    if (!options->common.jsonPath.empty()) writeJson(options->common.jsonPath, jsonOf(report));
    logInfo(summaryOf(report));
    logStages(timer);
    return 0;
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-grid", argc, argv, rt::gridMain);
}
