#pragma once
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/nest_options.h"

#include <span>

namespace rt {

/// What nestBricks() makes, in numbers.
struct NestedSize {
    double bricks = 0.0;
    double brickWords = 0.0;
    double leaves = 0.0;
    double referenceWords = 0.0; ///< exit boxes included
    double budgetWords = 0.0;    ///< that count against ReferenceLimit::references
};

/// Forecasts what nestBricks() will make of `grid`, from a few thousand of its voxels: those with long lists,
/// and of the others every so many references one, which then stands for them (systematic sampling by size:
/// Madow 1949). Exact for grids with few voxels. The result does not depend on the number of threads.
NestedSize forecastBricks(const CellRefs& grid, std::span<const TriangleRecord> triangles,
                          const GridLayout& layout, const NestOptions& options);

} // namespace rt
