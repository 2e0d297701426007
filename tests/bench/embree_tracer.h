// Embree as the benchmark's reference and as its peer on the CPU.
#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rt::bench {

/// Robust scenes lose next to no ray at an edge; Embree builds them without spatial splits and traces them
/// slower.
enum class EmbreeMode { Fast, Robust };

class EmbreeTracer {
public:
    /// Builds `repeat` times in high quality and keeps the last one.
    EmbreeTracer(const Mesh& mesh, EmbreeMode mode, unsigned repeat);
    ~EmbreeTracer();

    /// Median of the builds.
    double buildMs() const { return buildMs_; }

    struct Traced {
        std::vector<QueryHit> hits; ///< one per ray; for any-hit queries t and triangle of some hit
        double passMs = 0.0; ///< median of `repeat` passes over all rays, one ray at a time on all cores
    };
    Traced trace(std::span<const QueryRay> rays, bool anyHit, unsigned repeat) const;

    /// The same for 16 rays at a time, which is faster where neighbours go about the same way.
    double packetPassMs(std::span<const QueryRay> rays, bool anyHit, unsigned repeat) const;

    static std::string version();

private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
    double buildMs_ = 0.0;
};

} // namespace rt::bench
