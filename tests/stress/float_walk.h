#pragma once
#include "formats/atlas.shared.h"
#include "tests/support/split_mix.h"

namespace rt::test {

/// The walk of shaders/traverse.glsl in C++ floats, through free boxes of random sizes instead of an atlas',
/// and how far it is from the exact ray.
class FloatWalk {
public:
    /// The kind of structure is that of grid.dims.w.
    explicit FloatWalk(const GridParams& grid);

    /// How far the ray, from an origin inside the grid, gets from the boxes that the walk has it in, along
    /// the axis where that is most: in 2^-24 of the grid's longest side, where voxels count as cubes.
    double deviation(const glm::vec3& origin, const glm::vec3& direction, RayNumbers& numbers) const;

private:
    struct GridRay;
    struct ExactRay;

    GridRay toGridRay(const glm::vec3& origin, const glm::vec3& direction) const;
    ExactRay exactRay(const glm::vec3& origin, const glm::vec3& direction, const GridRay& ray) const;
    glm::ivec3 boxEnd(const glm::ivec3& at, RayNumbers& numbers) const;

    GridParams grid_;
    int finestLevel_;
    int mirrorSide_;
    glm::ivec3 size_; // of the grid, in the finest voxels that there may be
};

} // namespace rt::test
