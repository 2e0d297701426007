// What rt-trace found against what Embree found, ray by ray.
#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

namespace rt::bench {

class EmbreeTracer;

/// How a hit compares with the expected one. "Size" is |origin| + t |direction|, which rounding errors go
/// with.
enum class HitClass {
    Agree,   ///< both miss, or both hit the same triangle, |dt| <= 1e-5 of the size
    Tie,     ///< another triangle, |dt| / t < 1e-6: the ray meets an edge or a corner
    NearTie, ///< another triangle, |dt| above that but within 1e-6 of the size
    Grazing, ///< the same triangle, |dt| up to 1e-3 of the size: met edge on
    Edge,    ///< would be one of the following, but a ray 1e-6 of the size aside has this very hit
    Lost,    ///< only the expected hit is there
    Extra,   ///< only the other one is there
    Wrong,   ///< both hit, but elsewhere, or the record makes no sense or, see findDisplaced(), contradicts
             ///< itself
};
inline constexpr std::array kHitClassNames = {"agree", "ties", "nearTies", "grazing",
                                              "edges", "lost", "extra",    "wrong"};

struct HitCounts {
    std::uint64_t rays = 0;
    std::uint64_t hits = 0; ///< expected ones
    std::array<std::uint64_t, kHitClassNames.size()> ofClass{};
    std::vector<std::size_t> faults; ///< indices of the rays of the last three classes

    std::uint64_t& operator[](HitClass c) { return ofClass[static_cast<std::size_t>(c)]; }
    std::uint64_t operator[](HitClass c) const { return ofClass[static_cast<std::size_t>(c)]; }
};

/// {"rays": ..., "hits": ...} and the count of each class by its name.
nlohmann::json toJson(const HitCounts& counts);

/// What both need: spans of the same length. For any-hit queries only hit or miss is compared.
struct TracedRays {
    std::span<const QueryRay> rays;
    std::span<const QueryHit> expected;
    std::span<const QueryHit> got;
    bool anyHit = false;
};

/// Counts all classes but Edge. A miss is t = -1 and kNoTriangle; a record that says one of them without the
/// other is wrong, and so is a hit of which t, u or v is not finite.
HitCounts compareHits(const TracedRays& traced);

/// Moves faults to Edge where `tracer` finds what was got for one of 16 rays that run parallel to the ray,
/// 1e-6 of the size away: silhouettes, where rounding decides between hit and miss. A ray that slips through
/// between two triangles stays a fault, because its neighbours do not.
void excuseEdges(const EmbreeTracer& tracer, const TracedRays& traced, HitCounts& counts);

/// Moves to Wrong what is in no class of faults, but contradicts itself: the ray at t is off the triangle's
/// plane by more than 1e-5 of the size, or the triangle's point u, v off the ray by more than 1e-4, beside
/// roundings of 1e-6 of the triangle's edges. t alone may be right by chance, or of another triangle, and
/// grazing hits may be none. For any-hit queries nothing is looked at. Call it last.
void findDisplaced(const Mesh& mesh, const TracedRays& traced, HitCounts& counts);

} // namespace rt::bench
