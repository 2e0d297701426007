#pragma once
#include "tools/rt-grid/occupancy.h"

#include <cstdint>

namespace rt {

/// Gives the lists of a block's leaves their exit boxes: see atlas.shared.h. A box grows over voxels that are
/// empty, and from one leaf to the next where that lists nothing new. Of such steps only those are known that
/// the lists' headers name (LeafRelations), so that lists beyond a brick stop boxes: to look them up too
/// takes longer than all the rest, for a tenth of the gain. Boxes reach up to `reach` voxels beyond the leaf,
/// at most 31; the window shows so many round the block. Source: the expanded cells of Perard-Gayot,
/// Kalojanov & Slusallek 2017, "GPU Ray Tracing using Irregular Grids".
void growExits(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references, int reach);

/// The same, but of steps between leaves all those in the block `known` are found in the lists. It holds the
/// other block and goes less than `reach` voxels beyond it.
void growExits(const OccupancyWindow& window, const VoxelBlock& block, const VoxelBlock& known,
               std::uint32_t* references, int reach);

} // namespace rt
