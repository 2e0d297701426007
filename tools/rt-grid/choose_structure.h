#pragma once
#include "tools/rt-grid/nest_bricks.h"

#include <span>

namespace rt {

/// What a ray is expected to do in occupied voxels: the mean of one that crosses the scene anywhere and one
/// that goes to a triangle, since people look at where the detail is.
struct WorkForecast {
    double steps = 0.0; ///< leaves entered and bricks looked into
    double tests = 0.0; ///< triangles

    /// In tests. A step costs about as much as one and a half (by the instructions of both).
    double cost() const { return 1.5 * steps + tests; }
};

/// The structure that the forecasts favour.
struct StructureChoice {
    std::uint32_t structure = kStructureNested;
    WorkForecast nested;
    WorkForecast octant;
};

/// Chooses between a nested structure over the voxels of `cells` and an octant structure of `octantVoxels`
/// voxels for each of them. A random line through the grid meets a voxel with the ratio of their surfaces
/// (Santalo 1976), a ray to a triangle meets that triangle's; what it does there follows from the triangles'
/// sizes as in BrickCost. Looks at a few
/// thousand voxels at most. The result does not depend on the number of threads.
StructureChoice chooseStructure(const CellRefs& cells, std::span<const TriangleRecord> triangles,
                                const GridLayout& layout, const NestOptions& options, double octantVoxels);

} // namespace rt
