#include "tools/rt-trace/triangle_transforms.h"

#include <glm/geometric.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace rt {
namespace {

TriangleTransformDouble transformOf(const TriangleRecord& triangle) {
    const glm::dvec3 v0(triangle.v0);
    const glm::dvec3 edge1 = glm::dvec3(triangle.v1) - v0, edge2 = glm::dvec3(triangle.v2) - v0;
    const glm::dvec3 normal = glm::cross(edge1, edge2);
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    glm::dvec3 u(0.0), v(0.0);
    u[next] = edge2[last] / normal[axis];
    u[last] = -edge2[next] / normal[axis];
    v[next] = -edge1[last] / normal[axis];
    v[last] = edge1[next] / normal[axis];
    const glm::dvec3 plane = normal / normal[axis];
    return {glm::dvec4(u, -glm::dot(u, v0)), glm::dvec4(v, -glm::dot(v, v0)),
            glm::dvec4(plane, -glm::dot(plane, v0))};
}

template <class Transform>
std::vector<Transform> transformsOf(std::span<const TriangleRecord> triangles) {
    std::vector<Transform> transforms(triangles.size());
    tbb::parallel_for(std::size_t(0), triangles.size(), [&](std::size_t i) {
        const TriangleTransformDouble exact = transformOf(triangles[i]);
        using Row = decltype(Transform::u);
        transforms[i] = {Row(exact.u), Row(exact.v), Row(exact.plane)};
    });
    return transforms;
}

} // namespace

std::vector<TriangleTransform> triangleTransforms(std::span<const TriangleRecord> triangles) {
    return transformsOf<TriangleTransform>(triangles);
}

std::vector<TriangleTransformDouble> triangleTransformsDouble(std::span<const TriangleRecord> triangles) {
    return transformsOf<TriangleTransformDouble>(triangles);
}

} // namespace rt
