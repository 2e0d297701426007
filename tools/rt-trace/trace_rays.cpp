#include "tools/rt-trace/trace_rays.h"

#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/load_scene.h"
#include "tools/rt-trace/ray_order.h"
#include "tools/rt-trace/ray_query.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/trace_recipe.h"
#include "tools/rt-trace/warm_up.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <optional>

namespace rt {
namespace {

std::span<const QueryRay> asRays(const SharedSpan<std::byte>& bytes, const std::string& path) {
    if (bytes.size() % sizeof(QueryRay) != 0)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} bytes are not a whole number of rays of {} bytes", path, bytes.size(),
                                sizeof(QueryRay)));
    return {reinterpret_cast<const QueryRay*>(bytes.data()), bytes.size() / sizeof(QueryRay)};
}

// Rays from a stream may take half of the memory: their hits take as much in double precision.
StreamRule rayStream() {
    MemoryLimit half = defaultMemoryLimit();
    half.bytes /= 2;
    half.origin = "half of " + half.origin;
    return {0, {}, half};
}

struct Traced {
    std::vector<std::byte> hits; ///< records of hitBytes each
    std::size_t hitBytes = sizeof(QueryHit);
    std::vector<double> passesMs; ///< of all rays; sorted
    std::optional<WorkTotals> work;

    double medianMs() const { return medianOf(passesMs); }
    std::size_t rayCount() const { return hits.size() / hitBytes; }
    /// Records whose triangle is `id`.
    std::size_t count(std::uint32_t id) const {
        const std::size_t idOffset =
            hitBytes == sizeof(QueryHit) ? offsetof(QueryHit, tuvId.w) : offsetof(QueryHitDouble, triangle);
        std::size_t found = 0;
        for (std::size_t at = idOffset; at < hits.size(); at += hitBytes)
            found += std::memcmp(&hits[at], &id, sizeof id) == 0;
        return found;
    }
    std::size_t hitCount() const { return rayCount() - count(kNoTriangle); }
};

std::vector<double> timedPasses(const GpuRays& rays, const GlProgram& program, bool software,
                                unsigned repeat) {
    if (repeat > 0) warmUp([&] { rays.trace(program, 1, software); });
    return rays.trace(program, std::max(repeat, 1u), software);
}

struct QueryPrograms {
    const GlProgram& timed;
    const std::optional<GlProgram>& counting;
};

// Streams the rays through the device. A pass over all rays takes as long as that pass over each batch.
Traced traceBatches(std::span<const QueryRay> rays, GpuRays& gpuRays, const QueryPrograms& programs,
                    unsigned repeat, bool software, StageTimer& stages) {
    Traced traced;
    traced.hitBytes = gpuRays.hitBytes();
    traced.hits.resize(rays.size() * traced.hitBytes);
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
        gpuRays.readHits(std::span(traced.hits).subspan(first * traced.hitBytes, count * traced.hitBytes));
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
    features.doublePrecision = options.doublePrecision;
    features.countWork = options.stats;
    return features;
}

Traced trace(const TraceOptions& options, const GpuScene& scene, std::span<const QueryRay> rays,
             StageTimer& stages) {
    const GlContext& context = *scene.context;
    ResourcePlan counting = scene.plan;
    counting.features.countWork = options.stats;
    stages.begin("upload");
    GpuRays gpuRays(rays.size(), counting.features, context.limits());
    scene.atlas.bind();
    stages.begin("compile");
    gpuRays.finishCompiling(scene.programs.trace);
    stages.end();
    stages.add("firstDispatch", programMs());
    std::optional<GlProgram> countingProgram;
    if (options.stats) countingProgram = compileVariant(counting, scene.shaderCache()).trace;
    return traceBatches(rays, gpuRays, {scene.programs.trace, countingProgram}, options.repeat,
                        context.device().software, stages);
}

void writeReport(const TraceOptions& options, const Recipe& recipe, const GpuScene& scene,
                 const Traced& traced, const StageTimer& stages) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report;
    reportCommon(report, scene, stages);
    report["rays"] = traced.rayCount();
    report["hits"] = traced.hitCount();
    report["anyHit"] = options.anyHit;
    if (traced.work) reportWork(report, *traced.work, traced.medianMs());
    report["mraysPerSecond"] = mraysPerSecond(traced.rayCount(), traced.medianMs());
    if (options.repeat == 0) {
        report["gpuMs"] = traced.medianMs();
    } else {
        report["medianMs"] = traced.medianMs();
        report["minMs"] = traced.passesMs.front();
        report["repeat"] = options.repeat;
    }
    report[kHitsIdKey] = contentIdOf(traced.hits);
    writeReport(options.common.jsonPath, std::move(report), recipe);
}

} // namespace

void traceRays(const TraceOptions& options, const Recipe& recipe) {
    StageTimer stages;
    const SharedSpan<std::byte> rayBytes = readFile(options.raysPath, rayStream());
    const std::span<const QueryRay> rays = asRays(rayBytes, options.raysPath);
    const auto choose = [&](const Atlas& atlas, const GlLimits& limits) -> SceneNeeds {
        const SceneFeatures features = featuresFor(options, atlas, rays, limits);
        return {features,
                0,
                {{"rays and hits", GpuRays::bytesFor(rays.size(), features, limits),
                  "trace fewer rays at a time"}}};
    };
    const GpuScene scene = loadScene(options, ShaderKind::Query, choose, stages);
    const Traced traced = trace(options, scene, rays, stages);
    if (scene.plan.features.software)
        requireWholeWalks(traced.count(kWalkCutShort), "rays", options.scenePath);
    stages.begin("write");
    writeFile(options.outputPaths[0], std::as_bytes(std::span(traced.hits)));
    stages.end();
    std::string figures =
        fmt::format("{} rays, {} hits, {:.3f} ms", rays.size(), traced.hitCount(), traced.medianMs());
    if (!rays.empty())
        figures += fmt::format(", {:.1f} Mrays/s", mraysPerSecond(rays.size(), traced.medianMs()));
    logInfo(figures);
    logStages(stages);
    writeReport(options, recipe, scene, traced, stages);
}

} // namespace rt
