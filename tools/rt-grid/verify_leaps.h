#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/faults.h"

namespace rt {

/// What lets rays leap, proved from which voxels are empty and what leaves list: that these are right is
/// verifyLists()'s business.
struct LeapProof {
    Faults faults;
    std::uint64_t leaps = 0; ///< distances or boxes that were looked at
};

/// uniform and cloud: whether each distance is exactly the chessboard distance to the nearest occupied voxel,
/// INFO holds the largest, and no leaf has an exit box. The atlas must have passed validate().
LeapProof verifyDistances(const Atlas& atlas, WorkMeter& meter);

/// octant and nested: whether no leaf lies in an empty voxel's box, whole or in part, and those in a leaf's
/// exit box list only triangles that it lists too. The atlas must have passed validate().
LeapProof verifyBoxes(const Atlas& atlas, WorkMeter& meter);

} // namespace rt
