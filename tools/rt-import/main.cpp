#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "common/stage_timer.h"
#include "formats/mesh_file.h"
#include "tools/rt-import/guard_process.h"
#include "tools/rt-import/import_model.h"
#include "tools/rt-import/import_options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

void logSummary(const std::string& path, const ImportedModel& model, const StageTimer& timer) {
    for (const std::string& warning : model.report.warnings) logWarning(path + ": " + warning);
    logStages(timer);
    const Mesh& mesh = model.mesh;
    logInfo(fmt::format("{}: {} triangles, {} vertices, {} materials, {} images, {} bytes, {:.0f} ms", path,
                        mesh.triangles.size(), mesh.positions.size(), mesh.materials.size(),
                        mesh.images.size(), byteCount(mesh), timer.totalMs()));
}

int run(int argc, const char* const* argv) {
    ImportOptions options;
    if (!parseImportOptions(argc, argv, options)) return 0;
    const std::vector<std::string> outputs = outputsOf(options);
    for (const std::string& path : outputs) requireWritable(path);
    const std::string inputs = fmt::format("{}", fmt::join(options.sources.inputs, ", "));
    if (const std::optional<int> exitCode = forkGuarded(inputs)) return *exitCode;
    StageTimer timer;
    const ImportedModel model = importScene(options.sources, options.creaseDegrees, timer);
    requireDistinctPaths(model.filesRead, outputs); // textures and libraries count as inputs too
    timer.begin("write");
    writeMesh(options.outputPath, model.mesh);
    timer.end();
    if (!options.common.depfilePath.empty())
        writeDepfile(options.common.depfilePath, options.outputPath, model.filesRead);
    if (!options.common.jsonPath.empty())
        writeJson(options.common.jsonPath, toJson(model.report, model.mesh, timer));
    logSummary(inputs, model, timer);
    return 0;
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-import", argc, argv, rt::run);
}
