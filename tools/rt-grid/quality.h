#pragma once
#include "tools/rt-grid/nest_bricks.h"

namespace rt {

/// How much memory and build time speed may cost.
enum class Quality { fast, balanced, best };

/// What a quality means for each structure. Voxels per triangle are those of the grid, bricks not counted.
struct QualityPreset {
    double uniformVoxelsPerTriangle; ///< a plain walk pays for every voxel it crosses
    double cloudVoxelsPerTriangle;   ///< leaps make empty voxels cheap: fewer triangle tests win
    double octantVoxelsPerTriangle;
    double nestedVoxelsPerTriangle;
    NestOptions nest;

    double voxelsPerTriangle(std::uint32_t structure) const;
};

QualityPreset presetOf(Quality quality);

} // namespace rt
