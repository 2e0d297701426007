#include "tools/rt-trace/trace_rays.h"

#include "common/error.h"
#include "common/json_file.h"
#include "common/log.h"
#include "tools/rt-trace/ray_query.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/shader_variant.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

// GPUs idle at a fraction of their clock; they have reached it after this long (measured on an H200).
constexpr double kWarmUpMs = 1200.0;

std::span<const QueryRay> asRays(const SharedSpan<std::byte>& bytes, const std::string& path) {
    if (bytes.size() % sizeof(QueryRay) != 0)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} bytes are not a whole number of rays of {} bytes", path, bytes.size(),
                                sizeof(QueryRay)));
    return {reinterpret_cast<const QueryRay*>(bytes.data()), bytes.size() / sizeof(QueryRay)};
}

struct Traced {
    SceneFeatures features;
    std::vector<QueryHit> hits;
    std::vector<double> passesMs; ///< sorted
    std::optional<WorkTotals> work;

    double medianMs() const {
        const std::size_t half = passesMs.size() / 2;
        return passesMs.size() % 2 ? passesMs[half] : 0.5 * (passesMs[half - 1] + passesMs[half]);
    }
    std::uint64_t hitCount() const {
        return static_cast<std::uint64_t>(std::count_if(
            hits.begin(), hits.end(), [](const QueryHit& hit) { return hit.tuvId.w != kNoTriangle; }));
    }
};

std::vector<double> timedPasses(const GpuRays& rays, const GlProgram& program, bool software,
                                unsigned repeat) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    while (repeat > 0 && std::chrono::duration<double, std::milli>(Clock::now() - start).count() < kWarmUpMs)
        rays.trace(program, 1, software);
    std::vector<double> passesMs = rays.trace(program, std::max(repeat, 1u), software);
    std::sort(passesMs.begin(), passesMs.end());
    return passesMs;
}

Traced trace(const TraceOptions& options, const Atlas& atlas, std::span<const QueryRay> rays,
             const GlContext& context, StageTimer& stages) {
    const std::string& name = options.scenePath;
    const bool software = context.device().software;
    stages.begin("upload");
    ResourcePlan plan = planResources(atlas, queryFeatures(atlas, options.anyHit), ShaderKind::Query,
                                      context.limits().resources, name);
    const GpuAtlas gpuAtlas = uploadAtlas(atlas, plan, context.limits(), 0, name);
    const GpuRays gpuRays(rays, options.stats, context.limits());
    gpuAtlas.bind();
    stages.begin("compile");
    const GlProgram program = compileVariant(plan);
    gpuRays.warmUp(program);
    stages.end();
    Traced traced;
    traced.features = plan.features;
    traced.passesMs = timedPasses(gpuRays, program, software, options.repeat);
    stages.begin("readback");
    traced.hits = gpuRays.readHits();
    stages.end();
    if (options.stats) {
        plan.features.countWork = 1;
        const GlProgram counting = compileVariant(plan);
        gpuRays.trace(counting, 1, software);
        traced.work = sumWork(gpuRays.readCounters());
    }
    return traced;
}

void writeReport(const TraceOptions& options, const AtlasFile& file, const GlDevice& device,
                 const Traced& traced, const StageTimer& stages) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report;
    reportCommon(report, device, file, traced.features, stages);
    report["rays"] = traced.hits.size();
    report["hits"] = traced.hitCount();
    report["anyHit"] = options.anyHit;
    if (traced.work) reportWork(report, *traced.work, traced.medianMs());
    report["mraysPerSecond"] = mraysPerSecond(traced.hits.size(), traced.medianMs());
    if (options.repeat == 0) {
        report["gpuMs"] = traced.medianMs();
    } else {
        report["medianMs"] = traced.medianMs();
        report["minMs"] = traced.passesMs.front();
        report["repeat"] = options.repeat;
    }
    writeJson(options.common.jsonPath, report);
}

} // namespace

void traceRays(const TraceOptions& options) {
    StageTimer stages;
    stages.begin("load");
    const AtlasFile file = readAtlas(options.scenePath);
    const SharedSpan<std::byte> rayBytes = readFile(options.raysPath);
    const std::span<const QueryRay> rays = asRays(rayBytes, options.raysPath);
    stages.end();
    const std::unique_ptr<GlContext> context = GlContext::open(options.device, options.common.threads);
    const Traced traced = trace(options, file.atlas, rays, *context, stages);
    stages.begin("write");
    writeFile(options.outputPaths[0], std::as_bytes(std::span(traced.hits)));
    stages.end();
    logInfo(fmt::format("{} rays, {} hits, {:.3f} ms, {:.1f} Mrays/s", rays.size(), traced.hitCount(),
                        traced.medianMs(), mraysPerSecond(rays.size(), traced.medianMs())));
    writeReport(options, file, context->device(), traced, stages);
}

} // namespace rt
