#pragma once
#include "formats/gpu_interface.shared.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/gl_objects.h"

#include <cstddef>
#include <span>
#include <vector>

namespace rt {

/// Rays and their hits in the device's memory, in batches that fit one storage buffer and one dispatch each.
class GpuRays {
public:
    /// `countWork`: makes room for counters too. `maxBatch` lowers the batches' size (tests).
    GpuRays(std::span<const QueryRay> rays, bool countWork, const GlLimits& limits,
            std::uint64_t maxBatch = ~std::uint64_t(0));

    /// Traces every ray `passes` times with what is bound; returns each pass' milliseconds on the device.
    std::vector<double> trace(const GlProgram& program, unsigned passes, bool software) const;
    /// Makes the driver finish compiling, without tracing.
    void warmUp(const GlProgram& program) const;

    std::vector<QueryHit> readHits() const;
    /// (1, steps, tests, 0) per ray.
    std::vector<glm::uvec4> readCounters() const;

private:
    struct Batch {
        unsigned count;
        glm::uvec2 groups;
        GlBuffer params, rays, hits, counters;
    };
    void dispatch(const Batch& batch) const;

    std::vector<Batch> batches_;
    std::size_t count_ = 0;
};

} // namespace rt
