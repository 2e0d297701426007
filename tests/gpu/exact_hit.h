// Rays for tests, and brute force in double precision to compare with.
#pragma once
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"
#include "tests/support/make_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace rt::test {

inline constexpr float kNoEnd = 1e38f; ///< tMax of rays that go on

inline QueryRay rayFrom(const glm::vec3& origin, const glm::vec3& direction, float tMin = 0.0f,
                        float tMax = kNoEnd) {
    return {glm::vec4(origin, tMin), glm::vec4(direction, tMax)};
}

// Moller & Trumbore 1997 in double precision. `margin` is how far inside the triangle the point is, in
// barycentric units; negative outside.
struct ExactHit {
    double t = std::numeric_limits<double>::infinity();
    double u = 0.0, v = 0.0;
    double margin = -1.0;
    double weightError = 0.0; // that rounding of unit-sized coordinates makes in u and v
};

inline ExactHit intersectExactly(const Mesh& mesh, std::size_t triangle, const QueryRay& query) {
    const glm::uvec3& corners = mesh.triangles[triangle];
    const glm::dvec3 v0(mesh.positions[corners.x]), v1(mesh.positions[corners.y]),
        v2(mesh.positions[corners.z]);
    const glm::dvec3 direction(query.directionTmax);
    const glm::dvec3 p = glm::cross(direction, v2 - v0);
    const double determinant = glm::dot(v1 - v0, p);
    if (determinant == 0.0) return {};
    const glm::dvec3 fromV0 = glm::dvec3(query.originTmin) - v0;
    const glm::dvec3 q = glm::cross(fromV0, v1 - v0);
    const double u = glm::dot(fromV0, p) / determinant;
    const double v = glm::dot(direction, q) / determinant;
    const double longest = std::max(glm::length(v1 - v0), glm::length(v2 - v0));
    const double weightError = 1e-6 * longest * glm::length(direction) / std::abs(determinant);
    return {glm::dot(v2 - v0, q) / determinant, u, v, std::min({u, v, 1.0 - u - v}), weightError};
}

inline std::vector<QueryRay> randomRays(const Mesh& mesh, std::size_t count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::normal_distribution<float> normal;
    const Bounds bounds = boundsOf(mesh);
    std::vector<QueryRay> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 inside =
            bounds.lo + bounds.extent() * glm::vec3(unit(random), unit(random), unit(random));
        const glm::vec3 direction(normal(random), normal(random), normal(random));
        const glm::vec3 origin = i % 2 ? inside : inside - 3.0f * direction;
        const float tMin = i % 8 == 3 ? 0.3f * unit(random) : 0.0f;
        rays.push_back(rayFrom(origin, direction, tMin, i % 8 >= 6 ? tMin + 0.5f * unit(random) : kNoEnd));
    }
    return rays;
}

// Rays from `origin` at all vertices and at three points of each edge.
inline std::vector<QueryRay> raysAtVerticesAndEdges(const Mesh& mesh, const glm::vec3& origin) {
    std::vector<QueryRay> rays;
    for (const glm::vec3& vertex : mesh.positions) rays.push_back(rayFrom(origin, vertex - origin));
    for (const glm::uvec3& corners : mesh.triangles)
        for (const auto& [a, b] : {std::pair(corners.x, corners.y), std::pair(corners.y, corners.z)})
            for (const float along : {0.1f, 0.37f, 0.5f})
                rays.push_back(
                    rayFrom(origin, glm::mix(mesh.positions[a], mesh.positions[b], along) - origin));
    return rays;
}

} // namespace rt::test
