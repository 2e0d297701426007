#include "tests/stress/ray_targets.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <utility>

namespace rt::test {

QueryRay rayTowards(const glm::vec3& origin, const glm::vec3& target) {
    const glm::vec3 direction = target - origin;
    return rayFrom(origin, direction == glm::vec3(0.0f) ? glm::vec3(1.0f, 0.0f, 0.0f) : direction);
}

RayTargets::RayTargets(const Mesh& mesh, const GridParams& grid)
    : mesh_(mesh), grid_(grid), bounds_(boundsOf(mesh)) {}

glm::vec3 RayTargets::worldFromAtlas(const glm::vec3& p) const {
    return p / grid_.worldOffset.w + glm::vec3(grid_.worldOffset);
}

glm::vec3 RayTargets::vertex(RayNumbers& numbers) const {
    return mesh_.positions[triangle(numbers)[static_cast<int>(numbers.index(3))]];
}

glm::vec3 RayTargets::onEdge(RayNumbers& numbers) const {
    const glm::uvec3 t = triangle(numbers);
    const auto from = static_cast<int>(numbers.index(3));
    return glm::mix(mesh_.positions[t[from]], mesh_.positions[t[(from + 1) % 3]], numbers.unit());
}

glm::vec3 RayTargets::onTriangle(RayNumbers& numbers) const {
    const glm::uvec3 t = triangle(numbers);
    float u = numbers.unit();
    float v = numbers.unit();
    if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
    const glm::vec3 v0 = mesh_.positions[t.x];
    return v0 + (mesh_.positions[t.y] - v0) * u + (mesh_.positions[t.z] - v0) * v;
}

glm::vec3 RayTargets::voxelCorner(RayNumbers& numbers) const {
    glm::vec3 corner;
    for (int axis = 0; axis < 3; ++axis)
        corner[axis] = static_cast<float>(numbers.index(grid_.dims[axis] + 1));
    return worldFromAtlas(glm::vec3(grid_.gridLo) + corner * glm::vec3(grid_.cellSize));
}

glm::vec3 RayTargets::anywhere(RayNumbers& numbers) const {
    return bounds_.lo + bounds_.extent() * numbers.point();
}

glm::vec3 RayTargets::any(RayNumbers& numbers) const {
    switch (numbers.index(5)) {
    case 0:
        return vertex(numbers);
    case 1:
        return onEdge(numbers);
    case 2:
        return onTriangle(numbers);
    case 3:
        return voxelCorner(numbers);
    default:
        return anywhere(numbers);
    }
}

glm::vec3 RayTargets::toVoxelFaces(const glm::vec3& p, RayNumbers& numbers) const {
    const glm::vec3 lo(grid_.gridLo);
    const glm::vec3 inAtlas = (p - glm::vec3(grid_.worldOffset)) * grid_.worldOffset.w;
    const glm::vec3 faces = worldFromAtlas(lo + glm::round((inAtlas - lo) * glm::vec3(grid_.cellsPerUnit)) *
                                                    glm::vec3(grid_.cellSize));
    const std::size_t which = 1 + numbers.index(7);
    return glm::mix(p, faces, glm::bvec3(which & 1, which & 2, which & 4));
}

float RayTargets::diagonal() const {
    return glm::length(bounds_.extent());
}

} // namespace rt::test
