#include "common/json_file.h"
#include "common/log.h"
#include "tools/rt-trace/explain.h"
#include "tools/rt-trace/picture.h"
#include "tools/rt-trace/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

nlohmann::json samplesToJson(const TraceOptions& options, const Picture& picture) {
    return {{"wanted", options.samples},
            {"least", picture.tiles.least()},
            {"most", picture.tiles.most()},
            {"mean", picture.tiles.mean()},
            {"total", picture.figures.samples},
            {"seed", options.seed},
            {"timeLimitReached", picture.figures.timeLimitReached},
            {"dispatches", picture.figures.dispatches},
            {"tiles", picture.tiles.tiles().size()},
            {"tilesStoppedByError", picture.figures.tilesStopped}};
}

nlohmann::json sectionsToJson(const GpuScene& scene, const TraceOptions& options) {
    nlohmann::json sections = nlohmann::json::array();
    for (const SectionUse& use : sectionUses(scene.file.atlas, scene.plan, options.environment.empty()))
        sections.push_back({{"name", use.name}, {"bytes", use.bytes}, {"uploaded", use.uploaded}});
    return sections;
}

} // namespace

void logPicture(const Picture& picture, const TraceOptions& options) {
    const glm::uvec4& window = options.window;
    const double gpuMs = picture.figures.gpuMs;
    std::string figures = fmt::format("{}x{} in {:.2f} ms", window.z - window.x, window.w - window.y, gpuMs);
    if (options.samples > 1) figures += fmt::format(", {:.4g} samples per pixel", picture.tiles.mean());
    if (picture.figures.timeLimitReached) figures += ", ended by --time-limit";
    if (picture.heatMost > 0.0) figures += fmt::format(", yellow is {:.4g} per sample", picture.heatMost);
    if (const auto& work = picture.work)
        figures += fmt::format(", {} rays, {:.1f} Mrays/s, {:.2f} steps and {:.2f} tests per ray", work->rays,
                               mraysPerSecond(work->rays, gpuMs), double(work->steps) / double(work->rays),
                               double(work->tests) / double(work->rays));
    logInfo(figures);
}

void reportPicture(const Picture& picture, const TraceOptions& options, const GpuScene& scene,
                   const PictureSetup& setup, const StageTimer& stages) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report;
    reportCommon(report, scene, stages);
    reportCamera(report, setup.pose);
    report["width"] = options.window.z - options.window.x;
    report["height"] = options.window.w - options.window.y;
    report["gpuMs"] = picture.figures.gpuMs;
    report["earlierGpuMs"] = picture.earlierMs;
    report["samples"] = samplesToJson(options, picture);
    report["sections"] = sectionsToJson(scene, options);
    if (options.heat != Heat::None) report["heatMost"] = picture.heatMost;
    if (options.frames) report["frames"] = {options.frames->first, options.frames->last};
    if (picture.work) {
        reportWork(report, *picture.work, picture.figures.gpuMs);
        report["selfHits"] = picture.work->selfHits;
    }
    writeJson(options.common.jsonPath, report);
}

} // namespace rt
