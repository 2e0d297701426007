#pragma once
#include "formats/atlas.shared.h"

#include <cstddef>

namespace rt {

inline constexpr unsigned kMaxAutomaticSide = 1024;
inline constexpr unsigned kMaxRequestedSide = 65536;
inline constexpr double kMaxAutomaticVoxels = 1u << 28;

/// What the user asked for: `exact` if not 0, else `longestSide` if not 0, else `voxelsPerTriangle`.
struct ResolutionRequest {
    glm::uvec3 exact{0u};
    unsigned longestSide = 0;
    double voxelsPerTriangle = 0.0; ///< 0: as the quality has it for the structure
};

/// Returns the voxels per axis for a box of the given extents (all > 0).
/// exact: as asked. longestSide: that many along the longest axis, cubic voxels, at least 1 on each axis.
/// voxelsPerTriangle: cubic voxels, about that many per triangle in all, 1 to 1024 per axis.
/// Throws Error{LimitExceeded} if more than 65536 are asked for on an axis.
glm::uvec3 chooseResolution(const glm::dvec3& extent, std::size_t triangleCount,
                            const ResolutionRequest& request);

} // namespace rt
