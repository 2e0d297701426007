#pragma once
#include "formats/gpu_interface.shared.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/scene_features.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace rt {

/// One batch of rays and its hits in the device's memory: at most 2^24 rays, fewer where a storage buffer or
/// a dispatch takes fewer. The buffers are made once, for batches to stream through.
class GpuRays {
public:
    /// Makes room for batches of `rayCount` rays or of as many as a batch may have, and for what variants
    /// with these features need besides. Tests may lower the batches' size, and say how many scattered rays
    /// a lane may take one after the other.
    GpuRays(std::uint64_t rayCount, const SceneFeatures& features, const GlLimits& limits,
            std::uint64_t maxBatch = ~std::uint64_t(0), std::optional<unsigned> mostRaysPerLane = {});

    /// What so many rays take on the device.
    static std::uint64_t bytesFor(std::uint64_t rayCount, const SceneFeatures& features,
                                  const GlLimits& limits);
    std::uint64_t batchSize() const { return batchSize_; }
    /// Replaces the batch; at most batchSize() rays.
    void upload(std::span<const QueryRay> rays);

    /// Traces the batch `passes` times with what is bound; returns each pass' milliseconds on the device.
    std::vector<double> trace(const GlProgram& program, unsigned passes, bool software) const;
    /// Makes the driver finish compiling for what is bound, without tracing. Empties the batch.
    void finishCompiling(const GlProgram& program);

    /// Bytes of one hit: a QueryHit, or a QueryHitDouble in double precision.
    std::size_t hitBytes() const { return hitBytes_; }
    /// One hit for each ray of the batch.
    void readHits(std::span<std::byte> hits) const;
    /// (1, steps, tests, 0) per ray of the batch.
    std::vector<glm::uvec4> readCounters() const;

private:
    void bind() const;
    void restartQueue() const;

    GlLimits limits_;
    unsigned raysPerLane_; // on average
    unsigned mostRaysPerLane_;
    std::uint64_t batchSize_;
    std::size_t hitBytes_;
    unsigned count_ = 0; // rays of the batch
    GlBuffer params_, rays_, hits_, queue_, counters_;
};

} // namespace rt
