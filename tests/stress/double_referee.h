#pragma once
#include "formats/atlas.h"
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace rt::test {

/// Judges hits in single precision by those in double precision, and where the two differ by the triangles
/// themselves: a hit is wrong only where no rounding explains it.
///
/// A ray walks as if it were up to `lateralWorld` beside itself: with e = 2^-24, one rounding of the origin
/// at the grid's border, one of each corner minus the origin, five of the shear and three of the edge
/// functions come to about 10 e (|corner of the grid| + diagonal); 16 e are allowed. Rays from outside are
/// exact as far as the border but for the subtraction of the atlas' offset, where it has one. Along the ray,
/// t itself has four roundings, and the distance to a triangle's plane eight, divided by how much the plane
/// faces the ray; slivers, as the atlas marks them, keep to the first four where that would be more than 2^12
/// times as much.
class DoubleReferee {
public:
    /// Both must outlive it.
    DoubleReferee(const Mesh& mesh, const Atlas& atlas);

    bool isWrong(const QueryRay& ray, const QueryHit& hit, const QueryHitDouble& reference) const;

private:
    using Point = glm::vec<3, long double>; // double would lose what 10^9 diagonals leave of a scene
    struct Corners {
        Point a, b, c;
    };
    struct Claim; // a ray, a hit and how far that may be from where it says

    Corners cornersOf(std::uint32_t triangle) const;
    bool liesOn(const Claim& claim, std::uint32_t triangle, long double slack) const;
    long double clearanceOf(const Claim& claim, std::uint32_t triangle) const;
    long double planeBlur(const Claim& claim, std::uint32_t triangle) const;
    bool passesNear(const Claim& claim, const glm::dvec4& ball) const;
    bool passesOver(const Claim& claim, std::uint32_t triangle) const;
    bool passesOverAny(const Claim& claim) const;
    static long double distanceToSegment(const Point& p, const Point& a, const Point& b);
    static long double distanceToOutline(const Point& p, const Corners& t);
    static long double distanceTo(const Point& p, const Corners& t);

    const Mesh& mesh_;
    const Atlas& atlas_;
    std::vector<glm::dvec4> balls_; // round each triangle: centre and radius
    long double gridWorld_;         // largest coordinate of the grid and its diagonal
};

/// Judges for a StressCase that has a reference. `referee` must outlive it.
inline auto asInDouble(const DoubleReferee& referee) {
    return [&referee](const QueryRay& ray, const QueryHit& hit, const QueryHitDouble* reference) {
        return referee.isWrong(ray, hit, *reference);
    };
}

} // namespace rt::test
