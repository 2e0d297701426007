#include "tools/rt-trace/render.h"

#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace rt {
namespace {

// Of a queue, for each invocation: few enough that all lanes of a device have work.
constexpr unsigned kPixelsPerLane = 4;
constexpr unsigned kGroupsAcross = 32768;

unsigned groupsFor(unsigned pixels) {
    return (pixels + kGroupSide - 1) / kGroupSide;
}

} // namespace

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
                 bool queue)
    : params_(params), cameraBuffer_(createBuffer(std::as_bytes(std::span(&camera, 1)))),
      paramsBuffer_(createDynamicBuffer(sizeof(RenderParams))),
      lightBuffer_(createBuffer(std::as_bytes(std::span(lights)))) {
    if (queue) queueBuffer_ = createDynamicBuffer(sizeof(std::uint32_t));
}

void GpuView::bind() const {
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_CAMERA, cameraBuffer_.name());
    glBindBufferBase(GL_UNIFORM_BUFFER, RT_BINDING_RENDER, paramsBuffer_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_LIGHTS, lightBuffer_.name());
    if (queueBuffer_.name())
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_PIXELS, queueBuffer_.name());
    checkGl("binding the camera");
}

void GpuView::setWork(const glm::uvec4& region, unsigned first, unsigned count) const {
    RenderParams params = params_;
    params.region = region;
    params.samples.x = first;
    params.samples.y = count;
    updateBuffer(paramsBuffer_, std::as_bytes(std::span(&params, 1)));
}

void GpuView::dispatch(const glm::uvec4& region, unsigned first, unsigned count) const {
    setWork(region, first, count);
    const glm::uvec2 groups(groupsFor(region.z - region.x), groupsFor(region.w - region.y));
    if (!queueBuffer_.name()) {
        glDispatchCompute(groups.x, groups.y, 1);
        return;
    }
    constexpr std::uint32_t kNone = 0;
    updateBuffer(queueBuffer_, std::as_bytes(std::span(&kNone, 1)));
    const unsigned all = groups.x * groups.y;
    const unsigned few = (all + kPixelsPerLane - 1) / kPixelsPerLane;
    glDispatchCompute(std::min(few, kGroupsAcross), (few + kGroupsAcross - 1) / kGroupsAcross, 1);
}

void finishCompiling(const GlProgram& program, const GpuView& view) {
    glUseProgram(program.name());
    view.setWork(glm::uvec4(0), 0, 0); // nothing is drawn
    glDispatchCompute(1, 1, 1);
    glFinish();
    checkGl("starting the renderer");
}

} // namespace rt
