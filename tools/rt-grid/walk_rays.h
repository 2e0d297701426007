#pragma once
#include "formats/atlas.h"

namespace rt {

/// What rays do on average: voxels and boxes walked through, and triangles tested, until the nearest hit is
/// known or the grid is left.
struct WorkPerRay {
    double steps = 0.0;
    double tests = 0.0;
    double hits = 0.0; ///< share of the rays
};

/// Three kinds of rays, a few thousand of each, the same ones each time.
struct RaySample {
    std::size_t rays = 0; ///< of each kind
    WorkPerRay across;    ///< lines through the grid, evenly spread over places and directions
    WorkPerRay towards;   ///< from outside to a point of a triangle, all triangles alike
    WorkPerRay from;      ///< from such points on, to all sides
};

/// Walks rays through the atlas as shaders do, in double precision. The atlas must have passed validate().
RaySample walkRays(const Atlas& atlas);

/// As walkRays() walks it: the nearest triangle that a ray hits at a distance above tMin, in units of its
/// direction, or kNoHit. Origin and direction in voxels of the grid.
inline constexpr std::uint32_t kNoHit = ~0u;
std::uint32_t nearestTriangle(const Atlas& atlas, const glm::dvec3& origin, const glm::dvec3& direction,
                              double tMin);

} // namespace rt
