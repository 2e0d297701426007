#include "tests/bench/ray_sets.h"

#include "common/error.h"
#include "tests/support/split_mix.h"

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace rt::bench {
namespace {

using test::hashOf;

constexpr std::uint32_t kTileWidth = 8;
constexpr std::uint32_t kTileHeight = 4;
constexpr float kFar = 1e30f;
// Part of the largest coordinate by which secondary rays leave the surface. Large triangles are off by some
// roundings of their corners; nearer than this, which of two coplanar ones is hit would be chance.
constexpr double kOffset = 0x1p-14;

double radiusOf(const Bounds& bounds) {
    return 0.5 * glm::length(glm::dvec3(bounds.hi) - glm::dvec3(bounds.lo));
}

QueryRay makeRay(const glm::dvec3& origin, const glm::dvec3& direction, float tMax) {
    return {glm::vec4(glm::vec3(origin), 0.0f), glm::vec4(glm::vec3(direction), tMax)};
}

// In [-1, 1).
double signedUnit(std::uint32_t bits) {
    return static_cast<double>(bits) * 0x1p-31 - 1.0;
}

// Uniform on the unit sphere (Marsaglia 1972): square roots only, so the same on every machine.
glm::dvec3 pointOnSphere(std::uint64_t index) {
    for (std::uint64_t attempt = 0;; ++attempt) {
        const std::uint64_t bits = hashOf(index + (attempt << 40));
        const double x = signedUnit(static_cast<std::uint32_t>(bits));
        const double y = signedUnit(static_cast<std::uint32_t>(bits >> 32));
        const double s = x * x + y * y;
        if (s >= 1.0) continue;
        const double r = 2.0 * std::sqrt(1.0 - s);
        return {x * r, y * r, 1.0 - 2.0 * s};
    }
}

struct SurfacePoint {
    glm::dvec3 position;
    glm::dvec3 normal; ///< unit length, of the counter-clockwise triangle
    double offset;     ///< how far from the plane a float point is certain to be on its side
};

// From the barycentric coordinates: their errors stay in the triangle's plane, those of t do not.
SurfacePoint surfacePoint(const Mesh& mesh, const QueryRay& ray, const QueryHit& hit) {
    const glm::uvec3 corners = mesh.triangles[hit.tuvId.w];
    const glm::dvec3 a(mesh.positions[corners.x]);
    const glm::dvec3 b(mesh.positions[corners.y]);
    const glm::dvec3 c(mesh.positions[corners.z]);
    const double u = std::bit_cast<float>(hit.tuvId.y);
    const double v = std::bit_cast<float>(hit.tuvId.z);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    const glm::dvec3 largest = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
    return {a + (b - a) * u + (c - a) * v,
            length > 0.0 ? cross / length : -glm::normalize(glm::dvec3(ray.directionTmax)),
            kOffset * std::max({largest.x, largest.y, largest.z})};
}

// The point moved off the surface, to the side that `towards` points to.
glm::dvec3 leave(const SurfacePoint& point, const glm::dvec3& towards) {
    const double side = glm::dot(point.normal, towards) < 0.0 ? -1.0 : 1.0;
    return point.position + point.normal * (side * point.offset);
}

// makeOne(ray, hit, index among the hits) for every hit.
template <class F>
std::vector<QueryRay> perHit(std::span<const QueryRay> rays, std::span<const QueryHit> hits, F makeOne) {
    std::vector<std::size_t> sources;
    for (std::size_t i = 0; i < hits.size(); ++i)
        if (hits[i].tuvId.w != kNoTriangle) sources.push_back(i);
    std::vector<QueryRay> made(sources.size());
    tbb::parallel_for(std::size_t(0), made.size(),
                      [&](std::size_t i) { made[i] = makeOne(rays[sources[i]], hits[sources[i]], i); });
    return made;
}

} // namespace

glm::dvec3 framingEye(const Bounds& bounds, const glm::dvec3& target) {
    return target + glm::normalize(glm::dvec3(0.5, 0.35, 1.0)) * (1.875 * radiusOf(bounds));
}

glm::dvec3 lightAbove(const Bounds& bounds) {
    return glm::dvec3(bounds.centre()) + 1.5 * radiusOf(bounds) * glm::dvec3(0.4, 1.0, 0.3);
}

std::vector<QueryRay> primaryRays(const Camera& camera, std::uint32_t size) {
    const glm::dvec3 view = camera.target - camera.eye;
    const glm::dvec3 side = glm::cross(view, camera.up);
    if (!(glm::length(side) > 0.0))
        throw Error(ErrorKind::Usage,
                    "the camera looks along its up direction, or eye and target are one point; "
                    "give other --eye, --target or --up");
    const double half = std::tan(0.5 * glm::radians(camera.fovDegrees));
    const glm::dvec3 forward = glm::normalize(view);
    const glm::dvec3 right = glm::normalize(side) * half;
    const glm::dvec3 up = glm::cross(right, forward);
    std::vector<QueryRay> rays(std::size_t(size) * size);
    tbb::parallel_for(std::size_t(0), rays.size(), [&](std::size_t i) {
        const std::size_t tile = i / (kTileWidth * kTileHeight);
        const std::size_t inTile = i % (kTileWidth * kTileHeight);
        const std::size_t tilesPerRow = size / kTileWidth;
        const std::size_t x = tile % tilesPerRow * kTileWidth + inTile % kTileWidth;
        const std::size_t y = tile / tilesPerRow * kTileHeight + inTile / kTileWidth;
        const double across = (2.0 * double(x) + 1.0) / size - 1.0;
        const double down = (2.0 * double(y) + 1.0) / size - 1.0;
        rays[i] = makeRay(camera.eye, glm::normalize(forward + right * across - up * down), kFar);
    });
    return rays;
}

std::vector<QueryRay> shadowRays(const Mesh& mesh, std::span<const QueryRay> rays,
                                 std::span<const QueryHit> hits, const glm::dvec3& light) {
    return perHit(rays, hits, [&](const QueryRay& ray, const QueryHit& hit, std::size_t) {
        const SurfacePoint point = surfacePoint(mesh, ray, hit);
        const glm::dvec3 origin = leave(point, light - point.position);
        return makeRay(origin, light - origin, 0.9999f);
    });
}

std::vector<QueryRay> diffuseRays(const Mesh& mesh, std::span<const QueryRay> rays,
                                  std::span<const QueryHit> hits) {
    return perHit(rays, hits, [&](const QueryRay& ray, const QueryHit& hit, std::size_t index) {
        const SurfacePoint point = surfacePoint(mesh, ray, hit);
        const glm::dvec3 back = -glm::dvec3(ray.directionTmax);
        const glm::dvec3 normal = glm::dot(point.normal, back) < 0.0 ? -point.normal : point.normal;
        // The end points of cosine-distributed unit directions lie uniformly on a sphere that touches the
        // surface.
        const glm::dvec3 chord = normal + pointOnSphere(index);
        const double length = glm::length(chord);
        return makeRay(leave(point, back), length > 1e-6 ? chord / length : normal, kFar);
    });
}

std::vector<QueryRay> shuffled(std::vector<QueryRay> rays) {
    for (std::size_t i = rays.size(); i > 1; --i) std::swap(rays[i - 1], rays[hashOf(i) % i]);
    return rays;
}

} // namespace rt::bench
