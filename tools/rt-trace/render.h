#pragma once
#include "formats/gpu_interface.shared.h"
#include "tools/rt-trace/film.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/upload_atlas.h"

#include <span>

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

/// Camera and lights in the device's memory.
class GpuView {
public:
    /// `lights` are in atlas space, see chooseLights().
    GpuView(const CameraParams& camera, const std::vector<AtlasLight>& lights);
    void bind() const;
    const CameraParams& camera() const { return camera_; }
    /// Makes the next dispatch start at this row of the picture.
    void setFirstRow(unsigned row) const;

private:
    CameraParams camera_;
    GlBuffer cameraBuffer_, lightBuffer_;
};

/// Makes the driver finish compiling for what is bound: some do so at the first dispatch only.
void finishCompiling(const GlProgram& program, const GpuView& view);

/// Renders every row of view.camera().size into what is bound; returns milliseconds on the device.
double renderRows(const GlProgram& program, const GpuView& view, const GlContext& context);

} // namespace rt
