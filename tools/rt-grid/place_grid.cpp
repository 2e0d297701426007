#include "tools/rt-grid/place_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt {
namespace {

constexpr double kThinnestAxis = 1e-3;
constexpr double kMarginCells = 1.0 / 32.0; // at least; gridLo is rounded by at most a quarter of the pad

float roundedUp(double x) {
    const auto rounded = static_cast<float>(x);
    return double(rounded) >= x ? rounded : std::nextafter(rounded, std::numeric_limits<float>::infinity());
}

float roundedDown(double x) {
    return -roundedUp(-x);
}

BoundsD merged(BoundsD a, const BoundsD& b) {
    a.lo = glm::min(a.lo, b.lo);
    a.hi = glm::max(a.hi, b.hi);
    return a;
}

} // namespace

BoundsD gridBounds(std::span<const TriangleRecord> triangles) {
    using Range = tbb::blocked_range<std::size_t>;
    const auto addRange = [&](const Range& range, BoundsD bounds) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (const glm::vec4& v : {triangles[i].v0, triangles[i].v1, triangles[i].v2})
                bounds.add(glm::dvec3(v));
        return bounds;
    };
    BoundsD bounds = tbb::parallel_reduce(Range(0, triangles.size()), BoundsD{}, addRange, merged);
    const glm::dvec3 extent = bounds.extent();
    const double longest = std::max({extent.x, extent.y, extent.z});
    const double thinnest = longest > 0.0 ? kThinnestAxis * longest : kThinnestAxis;
    for (int axis = 0; axis < 3; ++axis) {
        const double missing = std::max(0.0, thinnest - extent[axis]);
        bounds.lo[axis] -= 0.5 * missing;
        bounds.hi[axis] += 0.5 * missing;
    }
    return bounds;
}

double padCellsFor(const glm::uvec3& dims, int level) {
    return std::max(0x1p-8, std::ldexp(std::max({dims.x, dims.y, dims.z}), level - 20));
}

GridLayout placeGrid(const BoundsD& bounds, const glm::uvec3& dims, double padScale) {
    GridLayout layout;
    layout.dims = dims;
    const double margin = std::max(kMarginCells, padCellsFor(dims, 0)); // the pad from 32768 voxels on
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = bounds.hi[axis] - bounds.lo[axis];
        layout.cellSize[axis] = roundedUp(extent / (dims[axis] - 2.0 * margin));
        layout.gridLo[axis] = roundedDown(bounds.lo[axis] - margin * double(layout.cellSize[axis]));
        layout.cellsPerUnit[axis] = 1.0f / layout.cellSize[axis];
    }
    layout.padScale = padScale;
    layout.padCells = padScale * padCellsFor(dims, 0);
    return layout;
}

} // namespace rt
