#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/faults.h"

namespace rt {

/// The pad that formats/README.md promises for voxels of `level`, in such voxels.
double promisedPad(const Atlas& atlas, int level);

/// References are the entries of all lists. Those without which a triangle would be missed are needed; a list
/// may hold others, which cost time only.
struct ListProof {
    Faults faults;
    std::uint64_t needed = 0;
    std::uint64_t held = 0;
};

/// Whether each triangle is in the list of every voxel, of whatever level, that its surface comes nearer to
/// than the promised pad. Voxels are found by clipping the triangle to slabs of them, then to columns: what
/// is left is a point of the triangle in the voxel. The atlas must have passed validate().
ListProof verifyLists(const Atlas& atlas, WorkMeter& meter);

/// Whether the lists ascend, each belongs to one leaf, and leaves and references are as many as INFO says.
Faults verifyCounts(const Atlas& atlas);

} // namespace rt
