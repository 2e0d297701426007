#include "tools/rt-trace/render.h"

#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

// Pixels are taken in blocks, so that neighbouring lanes see the same things.
constexpr glm::uvec2 kBlock(8, 4);

glm::uvec2 blocksIn(const glm::uvec4& region) {
    return (glm::uvec2(region.z, region.w) - glm::uvec2(region) + kBlock - 1u) / kBlock;
}

unsigned samplesIn(const glm::uvec4& region) {
    const glm::uvec2 blocks = blocksIn(region);
    return blocks.x * blocks.y * kBlock.x * kBlock.y;
}

// Cut between blocks; the region has more than one.
std::array<glm::uvec4, 2> halvesOf(const glm::uvec4& region) {
    const glm::uvec2 blocks = blocksIn(region);
    const int axis = blocks.y > 1 ? 1 : 0; // rows stay whole
    std::array<glm::uvec4, 2> halves = {region, region};
    halves[0][axis + 2] = halves[1][axis] = region[axis] + blocks[axis] / 2 * kBlock[axis];
    return halves;
}

} // namespace

std::uint64_t samplesToTrace(const glm::uvec4& window, unsigned samples) {
    return std::uint64_t(samplesIn(window)) * samples;
}

WorkTotals& WorkTotals::operator+=(const WorkTotals& other) {
    rays += other.rays;
    steps += other.steps;
    tests += other.tests;
    selfHits += other.selfHits;
    return *this;
}

WorkTotals sumWork(std::span<const glm::uvec4> counters) {
    WorkTotals totals;
    for (const glm::uvec4& counter : counters) {
        totals.rays += counter.x;
        totals.steps += counter.y;
        totals.tests += counter.z;
        totals.selfHits += counter.w;
    }
    return totals;
}

RenderParams wholePicture(glm::uvec2 size) {
    RenderParams params{};
    params.filterSize.x = 0.5f;
    params.size = {size, 0, 0};
    params.region = {0, 0, size};
    params.samples = {0, 1, 0, kFilterBox};
    return params;
}

GpuView::GpuView(const CameraParams& camera, const RenderParams& params, const std::vector<Light>& lights,
                 const SceneFeatures& features, const GlLimits& limits, std::uint64_t mostSamples)
    : params_(params), cameraBuffer_(createBuffer(std::as_bytes(std::span(&camera, 1)))),
      paramsBuffer_(createDynamicBuffer(sizeof(RenderParams))),
      lightBuffer_(createBuffer(std::as_bytes(std::span(lights)))), slots_(features, limits, mostSamples) {
    params_.slots = {slots_.count(), 0, 0, 0};
    if (features.multipass)
        passes_.emplace(glm::uvec2(params.region.z, params.region.w) - glm::uvec2(params.region));
    else
        rounds_.emplace(slots_.count());
}

void GpuView::bind() const {
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_CAMERA, cameraBuffer_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_RENDER, paramsBuffer_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_LIGHTS, lightBuffer_.name());
    slots_.bind();
    if (rounds_) rounds_->bind();
    if (passes_) passes_->bind();
    checkGl("binding the camera");
}

void GpuView::setBatch(const glm::uvec4& region, unsigned first, unsigned count) {
    RenderParams params = params_;
    params.region = region;
    params.samples.x += first;
    params.samples.y = count;
    updateBuffer(paramsBuffer_, std::as_bytes(std::span(&params, 1)));
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT); // pixels go on from their last sums
}

void GpuView::renderBatch(const GpuPrograms& programs, const glm::uvec4& region, unsigned first,
                          unsigned count) {
    setBatch(region, first, count);
    const glm::uvec4 corner(params_.size.z, params_.size.w, params_.size.z, params_.size.w);
    if (passes_)
        passes_->render(programs, region - corner, times_);
    else
        rounds_->render(programs, samplesIn(region) * count, times_);
}

void GpuView::warmUp(const GpuPrograms& programs) {
    setBatch(glm::uvec4(0), 0, 0);
    if (passes_)
        passes_->warmUp(programs);
    else
        rounds_->render(programs, 0, nullptr);
}

void GpuView::render(const GpuPrograms& programs, const glm::uvec4& region, unsigned first, unsigned count) {
    if (samplesIn(region) > slots_.count()) {
        for (const glm::uvec4& half : halvesOf(region)) render(programs, half, first, count);
        return;
    }
    const unsigned most = passes_ ? 1 : slots_.count() / samplesIn(region);
    for (unsigned done = 0; done < count; done += most)
        renderBatch(programs, region, first + done, std::min(most, count - done));
}

void finishCompiling(const GpuPrograms& programs, GpuView& view) {
    view.warmUp(programs);
    glFinish();
    checkGl("starting the renderer");
}

} // namespace rt
