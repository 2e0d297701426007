#pragma once
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"
#include "tests/gpu/exact_hit.h"
#include "tests/support/split_mix.h"

#include <vector>

namespace rt::test {

/// t = 1 at the target. Never without a direction.
QueryRay rayTowards(const glm::vec3& origin, const glm::vec3& target);

/// Points that rays have trouble with, world space.
class RayTargets {
public:
    /// `mesh` must outlive it.
    RayTargets(const Mesh& mesh, const GridParams& grid);

    glm::vec3 vertex(RayNumbers& numbers) const;
    glm::vec3 onEdge(RayNumbers& numbers) const;
    glm::vec3 onTriangle(RayNumbers& numbers) const;
    glm::vec3 voxelCorner(RayNumbers& numbers) const;
    /// Anywhere in the bounds of the mesh.
    glm::vec3 anywhere(RayNumbers& numbers) const;
    /// One of the above.
    glm::vec3 any(RayNumbers& numbers) const;

    /// `p` with some of its coordinates moved to the nearest plane between voxels, at least one of them.
    glm::vec3 toVoxelFaces(const glm::vec3& p, RayNumbers& numbers) const;

    const Bounds& bounds() const { return bounds_; }
    float diagonal() const;

private:
    glm::uvec3 triangle(RayNumbers& numbers) const {
        return mesh_.triangles[numbers.index(mesh_.triangles.size())];
    }
    glm::vec3 worldFromAtlas(const glm::vec3& p) const;

    const Mesh& mesh_;
    GridParams grid_;
    Bounds bounds_;
};

} // namespace rt::test
