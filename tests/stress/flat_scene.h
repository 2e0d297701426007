#pragma once
#include "formats/atlas.h"
#include "formats/mesh.h"
#include "tests/stress/ray_targets.h"
#include "tests/support/split_mix.h"

#include <functional>
#include <vector>

namespace rt::test {

using MovePoint = std::function<glm::vec3(const glm::vec3&)>;

/// The mesh with each position replaced.
Mesh mapped(const Mesh& mesh, const MovePoint& move);
/// Its triangles of which all corners have |x| and |y| up to `reach`, and all its vertices.
Mesh innerPart(const Mesh& mesh, float reach);

/// Sheets one above the other and a ray's way to their inner triangles.
struct FlatScene {
    Mesh mesh;
    Mesh inner;       ///< the triangles to aim at
    glm::vec3 normal; ///< of the sheets, unit
    float gap;        ///< from one sheet to the next, along the normal
};

/// `sheet`, which lies in z = 0, at each of `heights`, then moved by `move`, which turns +z to `normal`. Two
/// small triangles at opposite corners make the bounds a cube, so that the grid is the same whatever lies in
/// it.
FlatScene stack(const Mesh& sheet, const std::vector<float>& heights, float reach, const MovePoint& move,
                const glm::vec3& normal);
/// Heights of planes between voxels of a grid of `layers` voxels along z round such a scene, every other one.
std::vector<float> voxelFaces(unsigned layers);

/// Aimed at a vertex, an edge or a point of an inner triangle, from either side, out of the gap next to it: t
/// = 1 there, and beyond 2 at the next sheet.
QueryRay rayAtSheet(const FlatScene& scene, const RayTargets& inner, RayNumbers& numbers);
/// The ray of rayAtSheet() has missed the sheet that it was aimed at.
bool passesThrough(const QueryRay& ray, const QueryHit& hit, const QueryHitDouble*);

} // namespace rt::test
