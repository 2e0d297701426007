#pragma once
#include "common/stage_timer.h"
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

/// Voxels 2^level times finer than those of the layout, counted from the one at `first` on: what triangles
/// are in them is computed in double from the layout's floats.
class RT_LANES_ALIGNED VoxelSpace {
public:
    explicit VoxelSpace(const GridLayout& layout, int level = 0, const glm::ivec3& first = glm::ivec3(0))
        : lo_(lanesOf(glm::dvec3(layout.gridLo))),
          voxelsPerUnit_(lanesOf(std::ldexp(1.0, level) / glm::dvec3(layout.cellSize))),
          first_(lanesOf(glm::dvec3(first))) {}
    VoxelTriangle of(const TriangleRecord& triangle) const {
        return {of(triangle.v0), of(triangle.v1), of(triangle.v2)};
    }

private:
    Lanes of(const glm::vec4& corner) const { return (lanesOf(corner) - lo_) * voxelsPerUnit_ - first_; }
    Lanes lo_, voxelsPerUnit_, first_;
};

/// Lists every triangle in each voxel whose cube, grown by layout.padCells on every side, it meets; see
/// forEachVoxelOf(). The result does not depend on the number of threads. Memory: see limits.h.
/// `meter` counts the work. Throws Error{LimitExceeded} with limit.message when there are more references
/// than limit.references.
CellRefs binTriangles(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                      const ReferenceLimit& limit, WorkMeter& meter);

} // namespace rt
