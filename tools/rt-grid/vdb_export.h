#pragma once
#include "formats/atlas.h"
#include "formats/recipe.h"

#include <string>

namespace rt {

/// Returns the bytes of an OpenVDB file that shows the atlas' voxels: boolean grids "occupancy" and 32-bit
/// integer grids "distance" (of empty voxels; none for uniform) and "references" (of leaves); for nested one
/// of each for every level that has voxels, "occupancy_level0" and so on. Index (x, y, z) is the voxel,
/// counted in voxels of the level, and the transform takes it to the voxel's centre in world space. Other
/// voxels are inactive. Same atlas, same bytes. The first grid has the recipe's
/// mark as metadata, which is sealed.
std::string vdbBytes(const Atlas& atlas, const Recipe& recipe = {});

} // namespace rt
