#pragma once
#include "common/bounds.h"
#include "formats/atlas.shared.h"

#include <span>

namespace rt {

/// Where the voxels lie, atlas space. These floats are what the file holds: binning computes from them too.
struct GridLayout {
    glm::uvec3 dims{1u};
    glm::vec3 gridLo{0.0f};
    glm::vec3 cellSize{1.0f};
    glm::vec3 cellsPerUnit{1.0f};
    double padCells = 0.0; ///< triangles are listed in every voxel that they come this near to, in voxels
};

/// Bounds of the triangles, atlas space, each axis made at least a thousandth of the longest one thick, so
/// that a flat scene has a volume.
BoundsD gridBounds(std::span<const TriangleRecord> triangles);

/// The pad of voxels 2^level times smaller than those of a grid of `dims`, in such voxels: 2^-8, or 2^-20 of
/// the longest side in such voxels, whichever is more. A ray walked in floats from its entry into the grid is
/// off by up to 2^-22 (|o| + |t d|) / cellSize voxels, about 2^-21 of the side.
double padCellsFor(const glm::uvec3& dims, int level);

/// Returns a grid of `dims` voxels in which `bounds` lies at least 1/64 voxel away from every face.
/// Its pad is padCellsFor(dims, 0).
GridLayout placeGrid(const BoundsD& bounds, const glm::uvec3& dims);

} // namespace rt
