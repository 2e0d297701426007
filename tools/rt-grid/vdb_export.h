#pragma once
#include "formats/atlas.h"

#include <string>

namespace rt {

/// Returns the bytes of an OpenVDB file that shows the atlas' voxels: boolean grid "occupancy" (active where
/// occupied) and, for a cloud, 32-bit integer grid "distance" (active in empty voxels: the chessboard
/// distance in voxels; inactive 0 in occupied ones). Index (x, y, z) is the voxel, and the transform takes it
/// to the voxel's centre in world space. Same atlas, same bytes.
std::string vdbBytes(const Atlas& atlas);

} // namespace rt
