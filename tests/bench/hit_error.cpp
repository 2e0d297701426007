#include "tests/bench/hit_error.h"

#include "common/error.h"
#include "tests/bench/embree_tracer.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rt::bench {
namespace {

struct SurfacePoint {
    glm::dvec3 position, normal;
};

// The normal is of any length: only its direction counts.
SurfacePoint surfaceAt(const Mesh& mesh, const QueryHitDouble& hit) {
    const glm::uvec3 corners = mesh.triangles[hit.triangle];
    const glm::dvec3 weights(1.0 - hit.u - hit.v, hit.u, hit.v);
    SurfacePoint point{glm::dvec3(0.0), glm::dvec3(0.0)};
    for (int i = 0; i < 3; ++i) {
        point.position += weights[i] * glm::dvec3(mesh.positions[corners[i]]);
        point.normal += weights[i] * glm::dvec3(mesh.normals[corners[i]]);
    }
    return point;
}

// Exact for the smallest angles too, which the arc cosine is not.
double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

} // namespace

ErrorSpread spreadOf(std::vector<double> values) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (values.empty()) return {kNone, kNone, kNone};
    std::sort(values.begin(), values.end());
    // In thousandths, since 0.999 is no double: of 1000 values the 999th must not become the 1000th.
    const auto ranked = [&](std::size_t thousandths) {
        return values[(values.size() * thousandths + 999) / 1000 - 1];
    };
    return {ranked(500), ranked(999), values.back()};
}

HitErrors measureErrors(const Mesh& mesh, std::span<const QueryHitDouble> reference,
                        std::span<const QueryHitDouble> got) {
    const double diagonal = glm::length(glm::dvec3(boundsOf(mesh).extent()));
    std::vector<double> t, position, normal;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        const QueryHitDouble &a = reference[i], &b = got[i];
        if (a.triangle == kNoTriangle || a.triangle != b.triangle) continue;
        if (a.triangle >= mesh.triangles.size())
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("ray {} hits triangle {}, but the mesh has {}: hits of another scene", i,
                                    a.triangle, mesh.triangles.size()));
        if (!std::isfinite(b.t + b.u + b.v)) continue; // findFaults() counts it as wrong
        const SurfacePoint expected = surfaceAt(mesh, a), found = surfaceAt(mesh, b);
        const double apart = std::abs(b.t - a.t);
        t.push_back(apart == 0.0 ? 0.0 : apart / a.t); // a ray may start on what it hits
        position.push_back(glm::distance(expected.position, found.position) / diagonal);
        normal.push_back(angleBetween(expected.normal, found.normal));
    }
    const std::uint64_t compared = t.size();
    return {compared, spreadOf(std::move(t)), spreadOf(std::move(position)), spreadOf(std::move(normal))};
}

HitFaults findFaults(const Mesh& mesh, std::span<const QueryRay> rays,
                     std::span<const QueryHitDouble> reference, std::span<const QueryHitDouble> got) {
    std::vector<QueryHit> expected(rays.size()), judged(rays.size());
    std::transform(reference.begin(), reference.end(), expected.begin(), narrowed);
    std::transform(got.begin(), got.end(), judged.begin(), narrowed);
    const TracedRays traced{rays, expected, judged, false};
    HitFaults faults{compareHits(traced)};
    if (!faults.counts.faults.empty())
        excuseEdges(EmbreeTracer(mesh, EmbreeMode::Robust, 1), traced, faults.counts);
    faults.wrongTriangles = static_cast<std::uint64_t>(
        std::count_if(faults.counts.faults.begin(), faults.counts.faults.end(), [&](std::size_t i) {
            const std::uint32_t a = reference[i].triangle, b = got[i].triangle;
            return a != kNoTriangle && b != kNoTriangle && a != b;
        }));
    return faults;
}

QueryHitDouble widened(const QueryHit& hit) {
    return {std::bit_cast<float>(hit.tuvId.x), std::bit_cast<float>(hit.tuvId.y),
            std::bit_cast<float>(hit.tuvId.z), hit.tuvId.w, 0};
}

QueryHit narrowed(const QueryHitDouble& hit) {
    const auto bits = [](double value) { return std::bit_cast<std::uint32_t>(static_cast<float>(value)); };
    return {{bits(hit.t), bits(hit.u), bits(hit.v), hit.triangle}};
}

} // namespace rt::bench
