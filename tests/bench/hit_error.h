// How far hits are from those of a reference in double precision.
#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"
#include "tests/bench/hit_check.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rt::bench {

class EmbreeTracer;

/// Of all values, none interpolated: the smallest that at least that part of them do not exceed. NaN where
/// there are no values.
struct ErrorSpread {
    double median, p999, max;
};
ErrorSpread spreadOf(std::vector<double> values);

/// Over the rays for which both name the same triangle.
struct HitErrors {
    std::uint64_t compared = 0;
    ErrorSpread t{};        ///< |dt| / t of the reference
    ErrorSpread position{}; ///< distance of the points that u and v name, in diagonals of the scene's bounds
    ErrorSpread normal{};   ///< radians between the vertex normals interpolated by u and v
};

/// Both spans have the same length. Throws Error{InvalidContent} for a triangle that the mesh does not have.
HitErrors measureErrors(const Mesh& mesh, std::span<const QueryHitDouble> reference,
                        std::span<const QueryHitDouble> got);

/// What compareHits() and excuseEdges() say of hits, with the faults told apart.
struct HitFaults {
    HitCounts counts;
    std::uint64_t wrongTriangles = 0; ///< of HitClass::Wrong those that name another triangle
};
/// `mesh` is traced with Embree where hits are in dispute.
HitFaults findFaults(const Mesh& mesh, std::span<const QueryRay> rays,
                     std::span<const QueryHitDouble> reference, std::span<const QueryHitDouble> got);

QueryHitDouble widened(const QueryHit& hit);
QueryHit narrowed(const QueryHitDouble& hit);

} // namespace rt::bench
