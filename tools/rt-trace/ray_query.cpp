#include "tools/rt-trace/ray_query.h"

#include "tools/rt-trace/gpu_timer.h"
#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace rt {
namespace {

constexpr std::uint64_t kMostRays = 1u << 24; // of a batch: 768 MiB of rays and hits
constexpr const char* kFewerRays = "lower rt-grid's --resolution or trace fewer rays at a time";

// How many scattered rays an invocation takes from the queue. Few enough that all lanes of a device have
// work, many enough that they get some more when they are done. One where lanes do not know of each other,
// which is where Mesa's software renderer ends the loops of an invocation after 65,535 rounds.
struct RaysPerLane {
    unsigned average;
    unsigned most;
};
RaysPerLane raysPerLane(const SceneFeatures& features) {
    return features.scatteredRays && features.subgroups ? RaysPerLane{4, ~0u} : RaysPerLane{1, 1};
}

glm::uvec2 groupsFor(unsigned rays, unsigned perLane, const GlLimits& limits) {
    const unsigned perGroup = kRaysPerGroup * perLane;
    const unsigned groups = (rays + perGroup - 1) / perGroup;
    const unsigned x = std::clamp(groups, 1u, limits.groupCountX);
    return {x, (groups + x - 1) / x};
}

void bindStorage(GLuint binding, const GlBuffer& buffer) {
    if (buffer.name()) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
}

std::uint64_t batchOf(std::uint64_t rayCount, const GlLimits& limits) {
    const std::uint64_t perBuffer = limits.resources.storageBlockBytes / sizeof(QueryRay);
    const std::uint64_t perDispatch = std::uint64_t(limits.groupCountX) * limits.groupCountY * kRaysPerGroup;
    return std::min({rayCount, kMostRays, perBuffer, perDispatch});
}

std::size_t hitBytesOf(const SceneFeatures& features) {
    return features.doublePrecision ? sizeof(QueryHitDouble) : sizeof(QueryHit);
}

} // namespace

std::uint64_t GpuRays::bytesFor(std::uint64_t rayCount, const SceneFeatures& features,
                                const GlLimits& limits) {
    const std::size_t perRay =
        sizeof(QueryRay) + hitBytesOf(features) + (features.countWork ? sizeof(glm::uvec4) : 0);
    return batchOf(rayCount, limits) * perRay;
}

GpuRays::GpuRays(std::uint64_t rayCount, const SceneFeatures& features, const GlLimits& limits,
                 std::uint64_t maxBatch, std::optional<unsigned> mostRaysPerLane)
    : limits_(limits), raysPerLane_(raysPerLane(features).average),
      mostRaysPerLane_(mostRaysPerLane.value_or(raysPerLane(features).most)),
      batchSize_(std::min(batchOf(rayCount, limits), maxBatch)), hitBytes_(hitBytesOf(features)) {
    params_ = createDynamicBuffer(sizeof(QueryParams), kFewerRays);
    rays_ = createDynamicBuffer(batchSize_ * sizeof(QueryRay), kFewerRays);
    hits_ = createOutputBuffer(batchSize_ * hitBytes_, kFewerRays);
    if (features.scatteredRays) queue_ = createDynamicBuffer(sizeof(std::uint32_t), kFewerRays);
    if (features.countWork) counters_ = createOutputBuffer(batchSize_ * sizeof(glm::uvec4), kFewerRays);
}

void GpuRays::upload(std::span<const QueryRay> rays) {
    count_ = static_cast<unsigned>(rays.size());
    const QueryParams params{{count_, mostRaysPerLane_, 0, 0}};
    updateBuffer(params_, std::as_bytes(std::span(&params, 1)));
    updateBuffer(rays_, std::as_bytes(rays));
}

void GpuRays::bind() const {
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_QUERY, params_.name());
    bindStorage(RT_BUFFER_RAYS, rays_);
    bindStorage(RT_BUFFER_HITS, hits_);
    bindStorage(RT_BUFFER_QUEUE, queue_);
    bindStorage(RT_BUFFER_COUNTERS, counters_);
}

void GpuRays::restartQueue() const {
    if (!queue_.name()) return;
    const std::uint32_t first = 0;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); // a shader has changed it
    updateBuffer(queue_, std::as_bytes(std::span(&first, 1)));
}

std::vector<double> GpuRays::trace(const GlProgram& program, unsigned passes, bool software) const {
    glUseProgram(program.name());
    bind();
    const glm::uvec2 groups = groupsFor(count_, raysPerLane_, limits_);
    std::vector<GpuTimer> timers;
    for (unsigned pass = 0; pass < passes; ++pass) {
        GpuTimer& timer = timers.emplace_back(software);
        timer.begin();
        restartQueue();
        glDispatchCompute(groups.x, groups.y, 1);
        timer.end();
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); // passes write the same hits
    }
    std::vector<double> elapsedMs;
    for (const GpuTimer& timer : timers) elapsedMs.push_back(timer.elapsedMs());
    checkGl("tracing rays", kFewerRays);
    return elapsedMs;
}

void GpuRays::finishCompiling(const GlProgram& program) {
    upload({});
    glUseProgram(program.name());
    bind();
    restartQueue();
    glDispatchCompute(1, 1, 1);
    glFinish();
    checkGl("starting the ray queries", kFewerRays);
}

void GpuRays::readHits(std::span<std::byte> hits) const {
    readBuffer(hits_, hits);
}

std::vector<glm::uvec4> GpuRays::readCounters() const {
    std::vector<glm::uvec4> counters(count_);
    readBuffer(counters_, std::as_writable_bytes(std::span(counters)));
    return counters;
}

} // namespace rt
