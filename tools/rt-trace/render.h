#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/material.shared.h"
#include "tools/rt-trace/gl_objects.h"

#include <span>
#include <vector>

namespace rt {

/// What tracing has cost, summed over rays or pixels.
struct WorkTotals {
    std::uint64_t rays = 0;
    std::uint64_t steps = 0;    ///< voxels or leaps
    std::uint64_t tests = 0;    ///< triangles
    std::uint64_t selfHits = 0; ///< of pictures: rays that hit the triangle which they had just left

    WorkTotals& operator+=(const WorkTotals& other);
};
WorkTotals sumWork(std::span<const glm::uvec4> counters);

/// One sample in the middle of each pixel of a picture; black behind the scene, no ambient light.
RenderParams wholePicture(glm::uvec2 size);

/// Camera, parameters and lights in the device's memory.
class GpuView {
public:
    /// `lights` are in atlas space, see chooseLights().
    /// `queue`: the shader takes pixels from a queue (SceneFeatures::pixelQueue).
    GpuView(const CameraParams& camera, const RenderParams& params, const std::vector<Light>& lights,
            bool queue = false);
    void bind() const;
    /// Makes the next dispatch render this region, [xy, zw), and `count` samples from `first` on.
    void setWork(const glm::uvec4& region, unsigned first, unsigned count) const;
    /// setWork() and the dispatch itself.
    void dispatch(const glm::uvec4& region, unsigned first, unsigned count) const;

private:
    RenderParams params_;
    GlBuffer cameraBuffer_, paramsBuffer_, lightBuffer_, queueBuffer_;
};

/// Makes the driver finish compiling for what is bound: some do so at the first dispatch only.
void finishCompiling(const GlProgram& program, const GpuView& view);

} // namespace rt
