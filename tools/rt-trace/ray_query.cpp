#include "tools/rt-trace/ray_query.h"

#include "tools/rt-trace/gpu_timer.h"
#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace rt {
namespace {

glm::uvec2 groupsFor(unsigned rays, const GlLimits& limits) {
    const unsigned groups = (rays + kRaysPerGroup - 1) / kRaysPerGroup;
    const unsigned x = std::min(groups, limits.groupCountX);
    return {x, (groups + x - 1) / x};
}

void bindStorage(GLuint binding, const GlBuffer& buffer) {
    if (buffer.name()) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
}

} // namespace

GpuRays::GpuRays(std::span<const QueryRay> rays, bool countWork, const GlLimits& limits,
                 std::uint64_t maxBatch)
    : count_(rays.size()) {
    const std::uint64_t perBuffer = limits.resources.storageBlockBytes / sizeof(QueryRay);
    const std::uint64_t perDispatch = std::uint64_t(limits.groupCountX) * limits.groupCountY * kRaysPerGroup;
    const std::uint64_t most = std::min({perBuffer, perDispatch, maxBatch});
    for (std::size_t first = 0; first < rays.size(); first += most) {
        Batch batch{};
        batch.count = static_cast<unsigned>(std::min<std::uint64_t>(most, rays.size() - first));
        batch.groups = groupsFor(batch.count, limits);
        const QueryParams params{{batch.count, 0, 0, 0}};
        batch.params = createBuffer(std::as_bytes(std::span(&params, 1)));
        batch.rays = createBuffer(std::as_bytes(rays.subspan(first, batch.count)));
        batch.hits = createOutputBuffer(std::uint64_t(batch.count) * sizeof(QueryHit));
        if (countWork) batch.counters = createOutputBuffer(std::uint64_t(batch.count) * sizeof(glm::uvec4));
        batches_.push_back(std::move(batch));
    }
}

void GpuRays::dispatch(const Batch& batch) const {
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_QUERY, batch.params.name());
    bindStorage(RT_BUFFER_RAYS, batch.rays);
    bindStorage(RT_BUFFER_HITS, batch.hits);
    bindStorage(RT_BUFFER_COUNTERS, batch.counters);
    glDispatchCompute(batch.groups.x, batch.groups.y, 1);
}

std::vector<double> GpuRays::trace(const GlProgram& program, unsigned passes, bool software) const {
    glUseProgram(program.name());
    std::vector<GpuTimer> timers;
    for (unsigned pass = 0; pass < passes; ++pass) {
        GpuTimer& timer = timers.emplace_back(software);
        timer.begin();
        for (const Batch& batch : batches_) dispatch(batch);
        timer.end();
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); // passes write the same hits
    }
    std::vector<double> elapsedMs;
    for (const GpuTimer& timer : timers) elapsedMs.push_back(timer.elapsedMs());
    checkGl("tracing rays");
    return elapsedMs;
}

void GpuRays::warmUp(const GlProgram& program) const {
    if (batches_.empty()) return;
    const QueryParams none{};
    const GlBuffer params = createBuffer(std::as_bytes(std::span(&none, 1)));
    glUseProgram(program.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_QUERY, params.name());
    bindStorage(RT_BUFFER_RAYS, batches_[0].rays);
    bindStorage(RT_BUFFER_HITS, batches_[0].hits);
    bindStorage(RT_BUFFER_COUNTERS, batches_[0].counters);
    glDispatchCompute(1, 1, 1);
    glFinish();
    checkGl("starting the ray queries");
}

std::vector<QueryHit> GpuRays::readHits() const {
    std::vector<QueryHit> hits(count_);
    std::size_t first = 0;
    for (const Batch& batch : batches_) {
        readBuffer(batch.hits, std::as_writable_bytes(std::span(hits).subspan(first, batch.count)));
        first += batch.count;
    }
    return hits;
}

std::vector<glm::uvec4> GpuRays::readCounters() const {
    std::vector<glm::uvec4> counters(count_);
    std::size_t first = 0;
    for (const Batch& batch : batches_) {
        readBuffer(batch.counters, std::as_writable_bytes(std::span(counters).subspan(first, batch.count)));
        first += batch.count;
    }
    return counters;
}

} // namespace rt
