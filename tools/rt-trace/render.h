#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/material.shared.h"
#include "tools/rt-trace/ray_passes.h"
#include "tools/rt-trace/sample_slots.h"

#include <optional>
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

/// Of a window's pixels, [xy, zw), as they are traced: in blocks, which may reach beyond it.
std::uint64_t samplesToTrace(const glm::uvec4& window, unsigned samples);

/// Camera, parameters and lights in the device's memory.
class GpuView {
public:
    /// What is rendered lies in `params.region`. `lights` are in atlas space, see chooseLights(); `features`
    /// are the programs'. There will not be room for more than `mostSamples` samples.
    GpuView(const CameraParams& camera, const RenderParams& params, const std::vector<Light>& lights,
            const SceneFeatures& features, const GlLimits& limits, std::uint64_t mostSamples = 1u << 20);
    void bind() const;
    /// Renders `count` samples from `first` on, counted from the parameters', of each pixel of a region, [xy,
    /// zw).
    void render(const GpuPrograms& programs, const glm::uvec4& region, unsigned first, unsigned count);
    /// From now on the times of all that is rendered are added there, which makes it slower.
    void measure(StageTimes& times) { times_ = &times; }
    /// Of --kernel multipass, of all that was rendered.
    PassCounts passes() const { return passes_ ? passes_->counts() : PassCounts{}; }
    /// Dispatches the programs without rendering anything.
    void warmUp(const GpuPrograms& programs);

private:
    void setBatch(const glm::uvec4& region, unsigned first, unsigned count);
    void renderBatch(const GpuPrograms& programs, const glm::uvec4& region, unsigned first, unsigned count);

    RenderParams params_;
    GlBuffer cameraBuffer_, paramsBuffer_, lightBuffer_;
    SampleSlots slots_;
    std::optional<SampleRounds> rounds_; // one of the two
    std::optional<RayPasses> passes_;
    StageTimes* times_ = nullptr;
};

/// Makes the driver finish compiling for what is bound: some do so at the first dispatch only.
void finishCompiling(const GpuPrograms& programs, GpuView& view);

} // namespace rt
