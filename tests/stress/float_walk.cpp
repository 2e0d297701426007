#include "tests/stress/float_walk.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt::test {
namespace {

constexpr float kNever = 1e30f;
constexpr int kPlaceZero = 0x4B000000;

int placeAt(float position) {
    return std::bit_cast<int>(position + 8388607.5f) - kPlaceZero;
}

int largest(const glm::ivec3& v) {
    return std::max({v.x, v.y, v.z});
}

} // namespace

struct FloatWalk::GridRay {
    glm::vec3 origin, direction, inverse;
    glm::bvec3 backwards;
    glm::ivec3 least; // first voxel of the grid

    int placeAlong(int axis, float t) const { return placeAt(std::fma(direction[axis], t, origin[axis])); }
};

// In the same coordinates, turned round where the other is. Its points outside the grid count as the border.
struct FloatWalk::ExactRay {
    using Point = glm::vec<3, long double>;
    Point origin, direction, lo, hi;

    Point at(float t) const { return glm::clamp(origin + direction * static_cast<long double>(t), lo, hi); }
    // How far the point at t is below (above) the box, along the axis where that is most.
    long double below(const glm::ivec3& first, float t) const {
        const Point out = Point(first) - at(t);
        return std::max({out.x, out.y, out.z});
    }
    long double above(const glm::ivec3& end, float t) const {
        const Point out = at(t) - Point(end);
        return std::max({out.x, out.y, out.z});
    }
};

FloatWalk::FloatWalk(const GridParams& grid) : grid_(grid) {
    const unsigned longest = std::max({grid.dims.x, grid.dims.y, grid.dims.z});
    const bool isNested = grid.dims.w == kStructureNested;
    finestLevel_ = isNested ? finestLevelOf(longest) : 0;
    mirrorSide_ = isNested ? static_cast<int>(kMaxFinestSide) : 1 << std::max(findMSB(longest - 1u) + 1, 4);
    size_ = glm::ivec3(glm::uvec3(grid.dims)) << finestLevel_;
}

FloatWalk::GridRay FloatWalk::toGridRay(const glm::vec3& origin, const glm::vec3& direction) const {
    const glm::vec3 perUnit = glm::vec3(grid_.cellsPerUnit) * std::ldexp(1.0f, finestLevel_);
    const glm::vec3 size(size_);
    GridRay ray;
    ray.origin = (origin - glm::vec3(grid_.gridLo)) * perUnit;
    ray.direction = glm::abs(direction * perUnit);
    ray.backwards = glm::lessThan(direction, glm::vec3(0.0f));
    for (int axis = 0; axis < 3; ++axis) {
        const bool still = direction[axis] == 0.0f;
        float& at = ray.origin[axis];
        if (still) at = std::floor(std::clamp(at, 0.0f, size[axis] - 1.0f)) + 0.5f;
        if (ray.backwards[axis]) at = static_cast<float>(mirrorSide_) - at;
        ray.inverse[axis] = still ? kNever : 1.0f / ray.direction[axis];
        ray.least[axis] = ray.backwards[axis] ? mirrorSide_ - size_[axis] : 0;
    }
    return ray;
}

FloatWalk::ExactRay FloatWalk::exactRay(const glm::vec3& origin, const glm::vec3& direction,
                                        const GridRay& ray) const {
    using Point = ExactRay::Point;
    const Point perUnit = std::ldexp(1.0L, finestLevel_) / Point(glm::vec3(grid_.cellSize));
    ExactRay exact;
    exact.origin = (Point(origin) - Point(glm::vec3(grid_.gridLo))) * perUnit;
    exact.origin =
        glm::mix(exact.origin, static_cast<long double>(mirrorSide_) - exact.origin, ray.backwards);
    exact.direction = glm::abs(Point(direction) * perUnit);
    exact.lo = Point(ray.least);
    exact.hi = Point(ray.least + size_);
    return exact;
}

// Up to 1/4 of the grid away, so that a walk has few steps, and now and then only a voxel.
glm::ivec3 FloatWalk::boxEnd(const glm::ivec3& at, RayNumbers& numbers) const {
    const int shift = static_cast<int>(numbers.index(static_cast<std::size_t>(finestLevel_) + 1));
    const int sideShift = std::bit_width(static_cast<unsigned>(largest(size_)));
    const int farthest = numbers.index(8) ? std::max(sideShift - shift - 3, 0) : 0;
    const auto free = [&] { return static_cast<int>(numbers.index((std::size_t(1) << farthest) + 1)); };
    glm::ivec3 end;
    for (int axis = 0; axis < 3; ++axis) end[axis] = ((at[axis] >> shift) + free() + 1) << shift;
    return end;
}

double FloatWalk::deviation(const glm::vec3& origin, const glm::vec3& direction, RayNumbers& numbers) const {
    const GridRay ray = toGridRay(origin, direction);
    const ExactRay exact = exactRay(origin, direction, ray);
    const glm::ivec3 last = ray.least + size_ - 1;
    glm::ivec3 at;
    for (int axis = 0; axis < 3; ++axis)
        at[axis] = std::clamp(ray.placeAlong(axis, 0.0f), ray.least[axis], last[axis]);
    long double most = 0.0L;
    float latest = 0.0f; // the ray is in boxes up to here
    while (glm::all(glm::lessThanEqual(at, last))) {
        const glm::ivec3 end = boxEnd(at, numbers);
        const glm::vec3 exits = (glm::vec3(end) - ray.origin) * ray.inverse;
        const float t = std::min({exits.x, exits.y, exits.z});
        if (t > latest) { // otherwise the box has no part of the ray
            most = std::max({most, exact.below(at, latest), exact.above(end, t)});
            latest = t;
        }
        for (int axis = 0; axis < 3; ++axis) {
            const int inside = std::min(std::max(ray.placeAlong(axis, t), at[axis]), end[axis] - 1);
            at[axis] = exits[axis] == t ? end[axis] : inside;
        }
    }
    most = std::max(most, exact.below(glm::min(at, last + 1), latest)); // it has left the grid
    return static_cast<double>(most) * 0x1p24 / largest(size_);
}

} // namespace rt::test
