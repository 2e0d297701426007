#pragma once
#include "tools/rt-grid/nest_bricks.h"

namespace rt {

/// Replaces the 0 of each empty voxel, of the grid and of the bricks, by the word of an empty box round it:
/// see atlas.shared.h. Boxes are large, not largest. Lists get exit boxes that reach up to `exitReach` voxels
/// beyond their own; 0: none. `meter` counts the work. The result does not depend on the number of threads.
void growBoxes(NestedVoxels& nested, const glm::uvec3& dims, int exitReach, WorkMeter& meter);

} // namespace rt
