#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "formats/atlas_file.h"
#include "tools/rt-grid/report.h"
#include "tools/rt-grid/vdb_export.h"
#include "tools/rt-grid/verify_command.h"

#include <nlohmann/json.hpp>

#include <string_view>

namespace rt {
namespace {

int buildCommand(int argc, const char* const* argv) {
    const std::optional<GridOptions> options = parseGridOptions(argc, argv);
    if (!options) return 0;
    for (const std::string& path : outputsOf(*options)) requireWritable(path);
    StageTimer timer;
    timer.begin("read");
    const MeshFile mesh = readMesh(options->meshPath);
    const auto [atlas, choice] = buildAtlas(mesh, options->meshPath, options->build, timer);
    std::string vdb;
    if (!options->vdbPath.empty()) {
        timer.begin("vdb");
        vdb = vdbBytes(atlas);
    }
    timer.begin("write");
    writeAtlas(options->atlasPath, atlas);
    if (!options->vdbPath.empty()) writeFile(options->vdbPath, vdb);
    timer.end();
    const GridReport report{*options, atlas, choice, timer};
    if (!options->common.jsonPath.empty()) writeJson(options->common.jsonPath, jsonOf(report));
    logInfo(summaryOf(report));
    logStages(timer);
    return 0;
}

int gridMain(int argc, const char* const* argv) {
    const std::string_view command = argc > 1 ? argv[1] : "";
    if (command == "verify") return verifyCommand(argc - 1, argv + 1);
    return buildCommand(argc, argv);
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-grid", argc, argv, rt::gridMain);
}
