#pragma once
#include "tools/rt-grid/limits.h"
#include "tools/rt-grid/place_grid.h"
#include "tools/rt-grid/voxelize_triangle.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rt {

/// Which triangles each voxel holds.
struct CellRefs {
    /// dims.x*dims.y*dims.z words, x fastest: kOccupiedBit | offset into references, or 0 for an empty voxel.
    std::vector<std::uint32_t> voxels;
    /// One list per occupied voxel, in the voxels' order, without gaps, as in atlas.shared.h; no exit boxes.
    std::vector<std::uint32_t> references;
    std::uint64_t occupiedVoxels = 0;
    std::uint64_t referenceCount = 0; ///< triangles in all lists
};

/// A triangle's corners in voxels of the layout; computed in double from the layout's floats.
inline VoxelTriangle voxelTriangle(const TriangleRecord& triangle, const GridLayout& layout) {
    const glm::dvec3 lo(layout.gridLo);
    const glm::dvec3 voxelsPerUnit = 1.0 / glm::dvec3(layout.cellSize);
    return {(glm::dvec3(triangle.v0) - lo) * voxelsPerUnit, (glm::dvec3(triangle.v1) - lo) * voxelsPerUnit,
            (glm::dvec3(triangle.v2) - lo) * voxelsPerUnit};
}

/// Lists every triangle in each voxel whose cube, grown by layout.padCells on every side, it meets; see
/// forEachVoxelOf(). The result does not depend on the number of threads. Memory: see limits.h.
/// Throws Error{LimitExceeded} with limit.message when there are more references than limit.references.
CellRefs binTriangles(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                      const ReferenceLimit& limit);

} // namespace rt
