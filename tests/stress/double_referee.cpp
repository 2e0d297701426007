#include "tests/stress/double_referee.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt::test {
namespace {

constexpr long double kRoundoff = 0x1p-24L;
constexpr long double kLateralRoundings = 16.0L;
constexpr long double kAlongRoundings = 4.0L;
constexpr long double kPlaneRoundings = 8.0L;
constexpr long double kSlender = 0x1p-12L;

} // namespace

struct DoubleReferee::Claim {
    Point origin;
    Point along; // unit length
    bool isMiss;
    long double distance; // of the hit, or to the end of a ray without one, world units
    long double nearest;  // of the hits that are wanted
    long double lateral;  // by which the ray may be beside itself
    long double slack;    // and the hit beside the surface

    Point point() const { return origin + along * distance; }
};

DoubleReferee::DoubleReferee(const Mesh& mesh, const Atlas& atlas) : mesh_(mesh), atlas_(atlas) {
    const GridParams& grid = atlas.grid;
    const glm::vec3 lo(grid.gridLo);
    const glm::vec3 size = glm::vec3(grid.dims) * glm::vec3(grid.cellSize);
    const glm::vec3 largest = glm::max(glm::abs(lo), glm::abs(lo + size));
    gridWorld_ = (glm::length(largest) + glm::length(size)) / grid.worldOffset.w;
    balls_.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::dvec3 centre = (a + b + c) / 3.0;
        balls_.emplace_back(
            centre, std::max({glm::length(a - centre), glm::length(b - centre), glm::length(c - centre)}));
    }
}

DoubleReferee::Corners DoubleReferee::cornersOf(std::uint32_t triangle) const {
    const glm::uvec3& t = mesh_.triangles[triangle];
    return {Point(mesh_.positions[t.x]), Point(mesh_.positions[t.y]), Point(mesh_.positions[t.z])};
}

long double DoubleReferee::distanceToSegment(const Point& p, const Point& a, const Point& b) {
    const Point edge = b - a;
    const long double square = glm::dot(edge, edge);
    const long double at = square > 0.0L ? std::clamp(glm::dot(p - a, edge) / square, 0.0L, 1.0L) : 0.0L;
    return glm::length(p - (a + edge * at));
}

long double DoubleReferee::distanceToOutline(const Point& p, const Corners& t) {
    return std::min(
        {distanceToSegment(p, t.a, t.b), distanceToSegment(p, t.b, t.c), distanceToSegment(p, t.c, t.a)});
}

long double DoubleReferee::distanceTo(const Point& p, const Corners& t) {
    const Point normal = glm::cross(t.b - t.a, t.c - t.a);
    const auto isInside = [&](const Point& from, const Point& to) {
        return glm::dot(glm::cross(normal, to - from), p - from) >= 0.0L;
    };
    const long double length = glm::length(normal);
    if (length > 0.0L && isInside(t.a, t.b) && isInside(t.b, t.c) && isInside(t.c, t.a))
        return std::abs(glm::dot(p - t.a, normal)) / length;
    return distanceToOutline(p, t);
}

// How far inside the triangle's outline the ray passes, seen along the ray; negative outside.
long double DoubleReferee::clearanceOf(const Claim& claim, std::uint32_t triangle) const {
    const Corners t = cornersOf(triangle);
    const auto flat = [&](const Point& corner) {
        const Point fromOrigin = corner - claim.origin;
        return fromOrigin - claim.along * glm::dot(fromOrigin, claim.along);
    };
    const Corners seen{flat(t.a), flat(t.b), flat(t.c)};
    const long double u = glm::dot(glm::cross(seen.b, seen.c), claim.along);
    const long double v = glm::dot(glm::cross(seen.c, seen.a), claim.along);
    const long double w = glm::dot(glm::cross(seen.a, seen.b), claim.along);
    const bool isInside = std::min({u, v, w}) > 0.0L || std::max({u, v, w}) < 0.0L;
    const long double distance = distanceToOutline(Point(0.0L), seen);
    return isInside ? distance : -distance;
}

// By how much the distance to the triangle's plane may be off: see the class.
long double DoubleReferee::planeBlur(const Claim& claim, std::uint32_t triangle) const {
    const Corners t = cornersOf(triangle);
    const Point edge1 = t.b - t.a, edge2 = t.c - t.a;
    const long double size = glm::length(edge1) * glm::length(edge2);
    const long double facing = std::abs(glm::dot(glm::cross(edge1, edge2), claim.along));
    const bool isSliver = atlas_.triangles[triangle].v1.w != 0.0f;
    return facing > (isSliver ? kSlender * size : 0.0L)
               ? kPlaneRoundings * kRoundoff * gridWorld_ * size / facing
               : 0.0L;
}

// The claimed point is on the triangle.
bool DoubleReferee::liesOn(const Claim& claim, std::uint32_t triangle, long double slack) const {
    const Corners t = cornersOf(triangle);
    const Point p = claim.point();
    return distanceTo(Point(0.0L), {t.a - p, t.b - p, t.c - p}) <= slack + planeBlur(claim, triangle);
}

// The triangle is surely there, before the claimed hit, and not where that is.
bool DoubleReferee::passesOver(const Claim& claim, std::uint32_t triangle) const {
    if (clearanceOf(claim, triangle) <= claim.lateral) return false;
    const Corners t = cornersOf(triangle);
    const Point normal = glm::cross(t.b - t.a, t.c - t.a);
    const long double facing = glm::dot(normal, claim.along);
    const long double distance = glm::dot(normal, t.a - claim.origin) / facing;
    const long double blur =
        planeBlur(claim, triangle) + claim.slack * glm::length(normal) / std::abs(facing);
    if (!(distance >= claim.nearest + blur && distance + blur < claim.distance)) return false;
    return claim.isMiss || !liesOn(claim, triangle, 2.0L * claim.slack);
}

// False only if the ray passes by all of the triangle: quick.
bool DoubleReferee::passesNear(const Claim& claim, const glm::dvec4& ball) const {
    const glm::dvec3 fromOrigin = glm::dvec3(ball) - glm::dvec3(claim.origin);
    const glm::dvec3 along(claim.along);
    const glm::dvec3 beside = fromOrigin - along * glm::dot(fromOrigin, along);
    const double rounding = 1e-14 * glm::length(fromOrigin);
    return glm::length(beside) <= 1.001 * ball.w + rounding;
}

bool DoubleReferee::passesOverAny(const Claim& claim) const {
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i)
        if (passesNear(claim, balls_[i]) && passesOver(claim, i)) return true;
    return false;
}

bool DoubleReferee::isWrong(const QueryRay& ray, const QueryHit& hit, const QueryHitDouble& reference) const {
    const Point direction(glm::vec3(ray.directionTmax));
    const Point origin(glm::vec3(ray.originTmin));
    const long double length = glm::length(direction);
    const bool isMiss = hit.tuvId.w == kNoTriangle;
    const long double t = std::bit_cast<float>(hit.tuvId.x);
    const bool found = reference.triangle != kNoTriangle;
    if (isMiss && !found) return false;
    if (!isMiss && (hit.tuvId.w >= mesh_.triangles.size() || !std::isfinite(t))) return true;

    const Point offset(glm::vec3(atlas_.grid.worldOffset));
    const Point moved = glm::mix(origin - offset, Point(0.0L), glm::equal(offset, Point(0.0L)));
    const long double lateral = kLateralRoundings * kRoundoff * (gridWorld_ + glm::length(moved));
    const long double reach = length * (isMiss ? static_cast<long double>(reference.t) : t);
    const long double slack = lateral + kAlongRoundings * kRoundoff * reach;
    if (!isMiss && hit.tuvId.w == reference.triangle && std::abs(t - reference.t) * length <= slack)
        return false;
    const long double end = isMiss ? static_cast<long double>(ray.directionTmax.w) : t;
    const Claim claim{origin, direction / length, isMiss, end * length, ray.originTmin.w * length, lateral,
                      slack};
    if (!isMiss && (clearanceOf(claim, hit.tuvId.w) < -lateral || !liesOn(claim, hit.tuvId.w, slack)))
        return true;
    if (!found || reference.t >= end) return false; // nothing nearer is missed
    return passesOver(claim, reference.triangle) || passesOverAny(claim);
}

} // namespace rt::test
