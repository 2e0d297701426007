#include "tests/bench/hit_check.h"

#include "tests/bench/embree_tracer.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace rt::bench {
namespace {

constexpr double kTie = 1e-6; // of t
// Of the size.
constexpr double kNearTie = 1e-6;
constexpr double kSameDistance = 1e-5;
constexpr double kGrazing = 1e-3;
constexpr double kAcross = 1e-4;
constexpr double kRounding = 1e-6;        // of a triangle's edges
constexpr double kEndOfWorld = 1e15;      // Embree's floats overflow soon after
constexpr double kAside[] = {1e-6, 1e-7}; // the second one for needles
constexpr int kNeighbours = 16;           // at each distance

double distanceOf(const QueryHit& hit) {
    return std::bit_cast<float>(hit.tuvId.x);
}

bool isMiss(const QueryHit& hit) {
    return hit.tuvId.w == kNoTriangle;
}

bool isSound(const QueryHit& hit) {
    const double t = distanceOf(hit);
    if (isMiss(hit)) return t == -1.0;
    return t >= 0.0 && std::isfinite(t) && std::isfinite(std::bit_cast<float>(hit.tuvId.y)) &&
           std::isfinite(std::bit_cast<float>(hit.tuvId.z));
}

double sizeOf(const QueryRay& ray, double t) {
    return glm::length(glm::dvec3(ray.originTmin)) + t * glm::length(glm::dvec3(ray.directionTmax));
}

HitClass classOf(const QueryRay& ray, const QueryHit& expected, const QueryHit& got, bool anyHit) {
    if (!isSound(got)) return HitClass::Wrong;
    if (isMiss(expected)) return isMiss(got) ? HitClass::Agree : HitClass::Extra;
    if (isMiss(got)) return HitClass::Lost;
    if (anyHit) return HitClass::Agree;
    const double t = distanceOf(expected);
    const double apart = std::abs(distanceOf(got) - t);
    const auto within = [&](double part) {
        return apart * glm::length(glm::dvec3(ray.directionTmax)) <= part * sizeOf(ray, t);
    };
    if (got.tuvId.w == expected.tuvId.w) {
        if (within(kSameDistance)) return HitClass::Agree;
        return within(kGrazing) ? HitClass::Grazing : HitClass::Wrong;
    }
    if (apart < kTie * t) return HitClass::Tie;
    return within(kNearTie) ? HitClass::NearTie : HitClass::Wrong;
}

bool isFault(HitClass c) {
    return c >= HitClass::Lost;
}

// Rays on two circles round the ray, of the sizes that belong to the disputed hit.
std::vector<QueryRay> neighboursOf(const QueryRay& ray, double t) {
    const glm::dvec3 along = glm::normalize(glm::dvec3(ray.directionTmax));
    const glm::dvec3 other = std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(along, other));
    const glm::dvec3 up = glm::cross(right, along);
    std::vector<QueryRay> neighbours;
    for (const double aside : kAside)
        for (int i = 0; i < kNeighbours; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kNeighbours;
            const glm::dvec3 offset =
                (right * std::cos(angle) + up * std::sin(angle)) * (aside * sizeOf(ray, t));
            neighbours.push_back(ray);
            neighbours.back().originTmin = glm::vec4(glm::dvec3(ray.originTmin) + offset, ray.originTmin.w);
        }
    return neighbours;
}

// The distance of the farther of the two hits; Embree knows it where an any-hit record does not say.
double disputedDistance(const EmbreeTracer& tracer, const TracedRays& traced, std::size_t i) {
    const QueryHit expected =
        traced.anyHit ? tracer.trace(traced.rays.subspan(i, 1), false, 1).hits[0] : traced.expected[i];
    return std::max({distanceOf(expected), distanceOf(traced.got[i]), 0.0});
}

// Whether the hit would be right for a ray beside its own. At a silhouette that may be another triangle of
// the same edge.
bool fits(const QueryRay& ray, const QueryHit& beside, const QueryHit& got, bool anyHit) {
    if (!isFault(classOf(ray, beside, got, anyHit))) return true;
    const double apart = std::abs(distanceOf(got) - distanceOf(beside));
    return !isMiss(beside) && !isMiss(got) &&
           apart * glm::length(glm::dvec3(ray.directionTmax)) <=
               kSameDistance * sizeOf(ray, distanceOf(beside));
}

bool isEdge(const EmbreeTracer& tracer, const TracedRays& traced, std::size_t i) {
    if (!isSound(traced.got[i])) return false;
    const double t = disputedDistance(tracer, traced, i);
    if (sizeOf(traced.rays[i], t) > kEndOfWorld) return false;
    const std::vector<QueryRay> neighbours = neighboursOf(traced.rays[i], t);
    const std::vector<QueryHit> hits = tracer.trace(neighbours, traced.anyHit, 1).hits;
    return std::any_of(hits.begin(), hits.end(), [&](const QueryHit& hit) {
        return fits(traced.rays[i], hit, traced.got[i], traced.anyHit);
    });
}

// Whether the ray at t is off the triangle's plane, or the point u, v off the ray. Along a ray that meets its
// triangle edge on, t is far less sure than that. u and v have the rounding errors of a large triangle.
bool isDisplaced(const Mesh& mesh, const QueryRay& ray, const QueryHit& hit) {
    if (hit.tuvId.w >= mesh.triangles.size()) return true;
    const glm::uvec3 corners = mesh.triangles[hit.tuvId.w];
    const glm::dvec3 a(mesh.positions[corners.x]), ab = glm::dvec3(mesh.positions[corners.y]) - a,
                                                   ac = glm::dvec3(mesh.positions[corners.z]) - a;
    const double u = std::bit_cast<float>(hit.tuvId.y), v = std::bit_cast<float>(hit.tuvId.z);
    const glm::dvec3 direction(ray.directionTmax), normal = glm::cross(ab, ac);
    const glm::dvec3 fromA = glm::dvec3(ray.originTmin) + distanceOf(hit) * direction - a;
    const double offRay = glm::length(glm::cross(fromA - u * ab - v * ac, glm::normalize(direction)));
    const double offPlane = std::abs(glm::dot(fromA, normal)) / std::max(glm::length(normal), 1e-300);
    const double size = sizeOf(ray, distanceOf(hit));
    const double rounding = kRounding * (glm::length(ab) + glm::length(ac));
    return offRay > kAcross * size + rounding || offPlane > kSameDistance * size + rounding;
}

} // namespace

HitCounts compareHits(const TracedRays& traced) {
    HitCounts counts;
    counts.rays = traced.rays.size();
    for (std::size_t i = 0; i < traced.rays.size(); ++i) {
        counts.hits += isMiss(traced.expected[i]) ? 0 : 1;
        const HitClass c = classOf(traced.rays[i], traced.expected[i], traced.got[i], traced.anyHit);
        ++counts[c];
        if (isFault(c)) counts.faults.push_back(i);
    }
    return counts;
}

nlohmann::json toJson(const HitCounts& counts) {
    nlohmann::json report = {{"rays", counts.rays}, {"hits", counts.hits}};
    for (std::size_t c = 0; c < kHitClassNames.size(); ++c) report[kHitClassNames[c]] = counts.ofClass[c];
    return report;
}

void excuseEdges(const EmbreeTracer& tracer, const TracedRays& traced, HitCounts& counts) {
    std::erase_if(counts.faults, [&](std::size_t i) {
        if (!isEdge(tracer, traced, i)) return false;
        --counts[classOf(traced.rays[i], traced.expected[i], traced.got[i], traced.anyHit)];
        ++counts[HitClass::Edge];
        return true;
    });
}

void findDisplaced(const Mesh& mesh, const TracedRays& traced, HitCounts& counts) {
    if (traced.anyHit) return;
    for (std::size_t i = 0; i < traced.rays.size(); ++i) {
        const HitClass c = classOf(traced.rays[i], traced.expected[i], traced.got[i], false);
        if (isFault(c) || isMiss(traced.got[i]) || !isDisplaced(mesh, traced.rays[i], traced.got[i]))
            continue;
        --counts[c];
        ++counts[HitClass::Wrong];
        counts.faults.push_back(i);
    }
    std::sort(counts.faults.begin(), counts.faults.end());
}

} // namespace rt::bench
