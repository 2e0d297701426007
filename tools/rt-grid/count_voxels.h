#pragma once
#include "tools/rt-grid/place_grid.h"

#include <cstdint>
#include <span>

namespace rt {

struct VoxelCount {
    std::uint64_t occupied = 0;
    std::uint64_t references = 0;
};

/// What binTriangles() would list, counted in a bit for each voxel instead of made.
VoxelCount countVoxels(std::span<const TriangleRecord> triangles, const GridLayout& layout);

} // namespace rt
