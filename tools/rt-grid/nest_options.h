#pragma once

namespace rt {

/// Where voxels become bricks of finer voxels.
struct NestOptions {
    unsigned gridLeafSize = 2; ///< triangles that a voxel of the grid may list
    unsigned leafSize = 12;    ///< triangles that a voxel of a brick may list
    double wordCost = 0.009;   ///< see BrickCost
    int maxDepth = 3;          ///< bricks in bricks
    int exitReach = 1; ///< voxels beyond a leaf that its exit box may reach, at most 31; 0: no exit boxes
};

} // namespace rt
