#include "tools/rt-trace/trace_rays.h"

#include "common/error.h"
#include "common/json_file.h"
#include "common/log.h"
#include "tools/rt-trace/ray_order.h"
#include "tools/rt-trace/ray_query.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/shader_variant.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>

namespace rt {
namespace {

// GPUs idle at a fraction of their clock; this long is enough to reach it, as far as measured.
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
    std::vector<double> passesMs; ///< of all rays; sorted
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
    return rays.trace(program, std::max(repeat, 1u), software);
}

struct QueryPrograms {
    GlProgram timed;
    std::optional<GlProgram> counting;
};

// Streams the rays through the device. A pass over all rays takes as long as that pass over each batch.
Traced traceBatches(std::span<const QueryRay> rays, GpuRays& gpuRays, const QueryPrograms& programs,
                    unsigned repeat, bool software, StageTimer& stages) {
    Traced traced;
    traced.hits.resize(rays.size());
    traced.passesMs.resize(std::max(repeat, 1u));
    if (programs.counting) traced.work = WorkTotals();
    for (std::size_t first = 0; first < rays.size(); first += gpuRays.batchSize()) {
        const std::size_t count = std::min<std::size_t>(gpuRays.batchSize(), rays.size() - first);
        stages.begin("upload");
        gpuRays.upload(rays.subspan(first, count));
        stages.end();
        const std::vector<double> passesMs = timedPasses(gpuRays, programs.timed, software, repeat);
        for (std::size_t i = 0; i < passesMs.size(); ++i) traced.passesMs[i] += passesMs[i];
        stages.begin("readback");
        gpuRays.readHits(std::span(traced.hits).subspan(first, count));
        stages.end();
        if (!programs.counting) continue;
        gpuRays.trace(*programs.counting, 1, software);
        *traced.work += sumWork(gpuRays.readCounters());
    }
    std::sort(traced.passesMs.begin(), traced.passesMs.end());
    return traced;
}

SceneFeatures featuresFor(const TraceOptions& options, const Atlas& atlas, std::span<const QueryRay> rays,
                          const GlLimits& limits) {
    SceneFeatures features = queryFeatures(atlas, options.anyHit);
    // Where lanes cannot ask each other, those of scattered rays gain nothing from it.
    features.scatteredRays = options.rayOrder == RayOrder::Auto
                                 ? limits.subgroups && areScattered(rays, atlas.grid)
                                 : options.rayOrder == RayOrder::Scattered;
    features.subgroups = features.scatteredRays && limits.subgroups;
    return features;
}

Traced trace(const TraceOptions& options, const Atlas& atlas, std::span<const QueryRay> rays,
             const GlContext& context, StageTimer& stages) {
    const std::string& name = options.scenePath;
    stages.begin("upload");
    SceneFeatures features = featuresFor(options, atlas, rays, context.limits());
    features.countWork = options.stats;
    ResourcePlan plan = planResources(atlas, features, ShaderKind::Query, context.limits().resources, name);
    const GpuAtlas gpuAtlas = uploadAtlas(atlas, plan, context.limits(), 0, name);
    GpuRays gpuRays(rays.size(), features, context.limits());
    gpuAtlas.bind();
    plan.features.countWork = 0;
    stages.begin("compile");
    QueryPrograms programs{compileVariant(plan), std::nullopt};
    gpuRays.finishCompiling(programs.timed);
    stages.end();
    const SceneFeatures timed = plan.features;
    if (options.stats) {
        plan.features.countWork = 1;
        programs.counting = compileVariant(plan);
    }
    Traced traced = traceBatches(rays, gpuRays, programs, options.repeat, context.device().software, stages);
    traced.features = timed;
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
    logStages(stages);
    writeReport(options, file, context->device(), traced, stages);
}

} // namespace rt
