#include "common/binary_io.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "common/stage_timer.h"
#include "formats/mesh_file.h"
#include "tools/rt-import/import_message.h"
#include "tools/rt-import/import_options.h"
#include "tools/rt-import/import_recipe.h"
#include "tools/rt-import/model_formats.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <span>

namespace rt {
namespace {

void logSummary(const SceneSources& sources, const ImportedModel& model, const StageTimer& timer) {
    const ImportReport& report = model.report;
    for (const std::string& line : report.ledger.lines()) logWarning(withName(sources, line));
    for (const std::string& warning : report.warnings) logWarning(withName(sources, warning));
    logStages(timer);
    for (const std::string& line : detailLines(report)) logDetail(line);
    const Mesh& mesh = model.mesh;
    logInfo(fmt::format("{}: {} triangles, {} vertices, {} materials, {} images, {} bytes, {} left out, "
                        "{:.0f} ms",
                        nameOf(sources), mesh.triangles.size(), mesh.positions.size(), mesh.materials.size(),
                        mesh.images.size(), byteCount(mesh), byteCount(report.leftOut), timer.totalMs()));
}

// The child's half.
int importForParent(ImportOptions& options, GuardProcess& guard) {
    StageTimer timer;
    options.settings.progress = [&](double part) { guard.setProgress(part); };
    const ImportedModel model = importScene(options.sources, options.settings, timer);
    logSummary(options.sources, model, timer);
    guard.send(model.mesh, toText({model.filesAsked,
                                   toJson(model.report, model.mesh, timer)
                                       .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}));
    return 0;
}

// All of them or none.
void writeOutputs(const ImportOptions& options, const ReceivedMesh& received, const ImportMessage& message,
                  const ImportRecipe& recipe) {
    const Recipe whole = recipe.with(message.filesAsked);
    const std::optional<std::string> dependencies = recipe.dependencies(message.filesAsked);
    const std::string report = reportText(nlohmann::json::parse(message.report), whole);
    std::vector<OutputFile> beside;
    if (dependencies)
        beside.push_back({options.common.depfilePath, {std::as_bytes(std::span(*dependencies))}});
    if (!options.common.jsonPath.empty())
        beside.push_back({options.common.jsonPath, {std::as_bytes(std::span(report))}});
    writeMesh(options.outputPath, received.mesh, whole, beside);
}

int run(int argc, const char* const* argv) {
    ImportOptions options;
    if (!parseImportOptions(argc, argv, options)) return 0;
    if (options.listFormats) {
        writeFile("-", formatTable());
        return 0;
    }
    const std::vector<std::string> outputs = outputsOf(options);
    for (const std::string& path : outputs) requireWritable(path);
    const std::string name = nameOf(options.sources);
    const ImportRecipe recipe(options);
    if (recipe.isUpToDate()) return 0;
    GuardProcess guard(name, options.limits);
    if (guard.isChild()) return importForParent(options, guard);
    if (const int exitCode = guard.wait(); exitCode != 0) return exitCode;
    const ReceivedMesh received = guard.receive();
    const ImportMessage message = readMessage(received.message, name);
    requireDistinctPaths(recipe.found(message.filesAsked), outputs); // textures and libraries are inputs too
    writeOutputs(options, received, message, recipe);
    return 0;
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-import", argc, argv, rt::run);
}
