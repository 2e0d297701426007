#include "common/log.h"
#include "tools/rt-trace/picture.h"
#include "tools/rt-trace/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

nlohmann::json samplesToJson(const TraceOptions& options, const Picture& picture) {
    return {{"wanted", options.range.count},
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

} // namespace

void logPicture(const Picture& picture, const TraceOptions& options) {
    const glm::uvec4& window = options.window;
    const double gpuMs = picture.figures.gpuMs;
    std::string figures = fmt::format("{}x{} in {:.2f} ms", window.z - window.x, window.w - window.y, gpuMs);
    if (options.range.count > 1) figures += fmt::format(", {:.4g} samples per pixel", picture.tiles.mean());
    if (options.kernel == Kernel::Multipass)
        figures += fmt::format(", {} intersect, {} traverse and {} shade passes", picture.passes.intersect,
                               picture.passes.traverse, picture.passes.shade);
    if (picture.figures.timeLimitReached) figures += ", ended by --time-limit";
    if (picture.heatMost > 0.0) figures += fmt::format(", yellow is {:.4g} per sample", picture.heatMost);
    if (const auto& work = picture.work)
        figures += fmt::format(", {} rays, {:.1f} Mrays/s, {:.2f} steps and {:.2f} tests per ray", work->rays,
                               mraysPerSecond(work->rays, gpuMs), double(work->steps) / double(work->rays),
                               double(work->tests) / double(work->rays));
    logInfo(figures);
    if (picture.nonFinite > 0)
        logWarning(
            fmt::format("{} pixels have channels that are no finite numbers: light of more than 1e38, or "
                        "a variance of more than that, does not fit into floats",
                        picture.nonFinite));
}

nlohmann::json figuresOf(const Picture& picture, const TraceOptions& options, const PictureSetup& setup) {
    const bool multipass = options.kernel == Kernel::Multipass;
    nlohmann::json figures;
    reportCamera(figures, setup.pose);
    figures["width"] = options.window.z - options.window.x;
    figures["height"] = options.window.w - options.window.y;
    figures["kernel"] = multipass ? "multipass" : "compute";
    if (multipass)
        figures["passes"] = {{"intersect", picture.passes.intersect},
                             {"traverse", picture.passes.traverse},
                             {"shade", picture.passes.shade}};
    figures["gpuMs"] = picture.figures.gpuMs;
    figures["earlierGpuMs"] = picture.earlierMs;
    if (!picture.passesMs.empty()) {
        figures["minMs"] = picture.passesMs.front();
        figures["repeat"] = options.repeat;
    }
    figures["samples"] = samplesToJson(options, picture);
    figures["nonFinitePixels"] = picture.nonFinite;
    if (options.heat != Heat::None) figures["heatMost"] = picture.heatMost;
    if (picture.work) {
        reportWork(figures, *picture.work, picture.figures.gpuMs);
        figures["selfHits"] = picture.work->selfHits;
        const StageTimes& times = picture.stageTimes;
        figures["deviceStages"] = {
            {"traceMs", times.traceMs}, {"shadeMs", times.shadeMs}, {"resolveMs", times.resolveMs}};
        if (multipass) figures["deviceStages"]["intersectMs"] = times.intersectMs;
    }
    return figures;
}

} // namespace rt
