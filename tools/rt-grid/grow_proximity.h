#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace rt {

/// Replaces the 0 of each empty voxel by its chessboard distance, in voxels, to the nearest occupied one
/// (kOccupiedBit set); occupied words stay. dims.x*dims.y*dims.z words, x fastest, of which at least one must
/// be occupied. Exact: in two passes within each z slice, then one sweep up and one down over the slices.
/// Source: Cohen & Sheffer 1994, "Proximity Clouds".
std::vector<std::uint32_t> growProximity(std::vector<std::uint32_t> voxels, const glm::uvec3& dims);

} // namespace rt
