#pragma once
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/sample_slots.h"

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

namespace rt {

/// How often each of the passes was drawn.
struct PassCounts {
    std::uint64_t intersect = 0, traverse = 0, shade = 0;

    PassCounts operator-(const PassCounts& before) const {
        return {intersect - before.intersect, traverse - before.traverse, shade - before.shade};
    }
};

/// --kernel multipass: three fragment shaders, drawn in turn over all pixels until none has a ray left, the
/// rays in textures (Karlsson & Ljungstedt 2004). What else samples need waits in SampleSlots, whose place of
/// a sample is that of its pixel in the region.
class RayPasses {
public:
    /// For pictures, or parts of them, up to this size.
    explicit RayPasses(glm::uvec2 size);
    static std::uint64_t bytesFor(glm::uvec2 size);
    void bind() const;
    /// Renders a sample of each pixel of a region, [xy, zw) of the textures, with the parameters that are
    /// bound. `times` as for SampleRounds::render().
    void render(const GpuPrograms& programs, const glm::uvec4& region, StageTimes* times);
    /// Draws each pass without rendering anything.
    void warmUp(const GpuPrograms& programs);
    /// Of all that was rendered.
    const PassCounts& counts() const { return counts_; }

private:
    void intersect(const GpuPrograms& programs, StageTimes* times);
    void traverse(const GpuPrograms& programs, StageTimes* times);
    void shade(const GpuPrograms& programs, unsigned stage, StageTimes* times);
    bool iterate(const GpuPrograms& programs, StageTimes* times, bool isAsked);

    std::array<GlTexture, kRayTextureCount> textures_;
    GlTexture depth_;
    GlFramebuffer intersectTarget_, traverseTarget_, shadeTargets_;
    GlVertexArray noVertices_;
    GlQuery anyRay_;
    PassCounts counts_;
};

} // namespace rt
