#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/fresh_array.h"
#include "tools/rt-grid/nest_options.h"

#include <span>
#include <vector>

namespace rt {

/// A nested structure without its boxes: empty voxels are 0. The exit boxes of leaves in bricks name steps
/// from leaf to leaf instead: see LeafRelations.
struct NestedVoxels {
    std::vector<std::uint32_t> voxels;
    FreshArray<std::uint32_t> bricks;
    FreshArray<std::uint32_t> references;
    std::vector<BrickPlace> places; ///< of all bricks, in the order of bricksOf()
    std::uint64_t occupiedVoxels = 0;
    std::uint64_t referenceCount = 0;
};

/// Puts bricks into voxels with too many triangles, and bricks into bricks. A brick has (2^k)^3 voxels,
/// k = 1 to 5, as BrickCost has it. A voxel stays a leaf in spite of its many triangles where the finer
/// voxels would cost more than they save, where a brick would not part the triangles (they share a vertex),
/// or where voxels would become smaller than kMaxFinestSide allows. Triangles are listed in every voxel that
/// they come within padCellsFor() of. The result does not depend on the number of threads. `meter` counts
/// the work. Throws Error{LimitExceeded} with limit.message when words of bricks and of lists are more than
/// limit.references, the grid's references included.
NestedVoxels nestBricks(CellRefs grid, std::span<const TriangleRecord> triangles, const GridLayout& layout,
                        const NestOptions& options, const ReferenceLimit& limit, WorkMeter& meter);

} // namespace rt
