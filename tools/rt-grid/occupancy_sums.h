#pragma once
#include "tools/rt-grid/atlas_cells.h"

#include <vector>

namespace rt {

/// How many voxels of a box hold leaves, in whole or in part: a summed table (Crow 1984) in three dimensions.
class OccupancySums {
public:
    /// Counts in `region`. What was counted before is forgotten.
    void count(const Atlas& atlas, const CellBox& region);

    /// The occupied voxels of the box, which has the region's level. It lies in the region, but for parts
    /// outside the grid, where nothing is.
    std::uint32_t in(const CellBox& box) const;

private:
    void mark(const CellBox& part);
    std::size_t index(const glm::ivec3& corner) const {
        return (static_cast<std::size_t>(corner.z) * stride_.y + static_cast<std::size_t>(corner.y)) *
                   stride_.x +
               static_cast<std::size_t>(corner.x);
    }

    CellBox region_;                  // inside the grid
    glm::uvec3 stride_{1u};           // one more than voxels of the region, along each axis
    std::vector<std::uint32_t> sums_; // of the voxels before each corner of a voxel
};

} // namespace rt
