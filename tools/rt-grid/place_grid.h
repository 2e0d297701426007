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
    double padScale = 1.0; ///< of the pads of all levels; less than 1 loses hits
};

/// Bounds of the triangles, atlas space, each axis made at least a thousandth of the longest one thick, so
/// that a flat scene has a volume.
BoundsD gridBounds(std::span<const TriangleRecord> triangles);

/// The pad of voxels 2^level times smaller than those of a grid of `dims`, in such voxels: 2^-8, or 2^-20 of
/// the longest side in such voxels, whichever is more. That is 16 * 2^-24 of the side or more; a walk in
/// floats is off by up to 7 of these 16, the test of a triangle by up to 6: see shaders/README.md.
double padCellsFor(const glm::uvec3& dims, int level);

/// Returns a grid of `dims` voxels in which `bounds` lies at least 1/64 voxel, and 12 * 2^-24 of the longest
/// side, away from every face: a walk may leave the grid too early by 7 of these. Its pad is `padScale` times
/// padCellsFor(dims, 0).
GridLayout placeGrid(const BoundsD& bounds, const glm::uvec3& dims, double padScale = 1.0);

} // namespace rt
