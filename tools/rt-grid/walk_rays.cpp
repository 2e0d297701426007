#include "tools/rt-grid/walk_rays.h"

#include "tools/rt-grid/atlas_cells.h"
#include "tools/rt-grid/triangle_lists.h"

#include <glm/geometric.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rt {
namespace {

constexpr std::uint64_t kRays = 8192; // of each kind
constexpr double kNever = 1e300;

struct Ray {
    glm::dvec3 origin, direction; // in voxels of the grid
    double tMin;
};

struct Work {
    std::uint64_t steps = 0, tests = 0, hits = 0;
    Work operator+(const Work& other) const {
        return {steps + other.steps, tests + other.tests, hits + other.hits};
    }
};

// Triangles in voxels of the grid.
class Space {
public:
    explicit Space(const Atlas& atlas) : lo_(atlas.grid.gridLo), size_(atlas.grid.cellSize) {}
    glm::dvec3 of(const glm::vec4& corner) const { return (glm::dvec3(corner) - lo_) / size_; }

private:
    glm::dvec3 lo_, size_;
};

class Walk {
public:
    Walk(const Atlas& atlas, const Ray& ray) : atlas_(atlas), space_(atlas), ray_(ray) {}

    void run() {
        const glm::dvec3 dims(atlas_.grid.dims);
        double t = 0.0, tLeave = kNever;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = ray_.direction[axis], o = ray_.origin[axis];
            if (d == 0.0 && (o < 0.0 || o > dims[axis])) return;
            if (d == 0.0) continue;
            t = std::max(t, ((d > 0.0 ? 0.0 : dims[axis]) - o) / d);
            tLeave = std::min(tLeave, ((d > 0.0 ? dims[axis] : 0.0) - o) / d);
        }
        if (t > tLeave) return;
        finest_ = glm::clamp(placeAt(t), glm::ivec3(0), gridEnd() - 1);
        do {
            ++work_.steps;
            t = step();
        } while (t <= best_ && isInGrid());
        work_.hits = hit_ != kNoHit;
    }
    const Work& work() const { return work_; }
    std::uint32_t hit() const { return hit_; }

private:
    glm::ivec3 gridEnd() const { return glm::ivec3(atlas_.grid.dims) << finestLevel(); }
    int finestLevel() const {
        const glm::uvec4& dims = atlas_.grid.dims;
        return dims.w == kStructureNested ? finestLevelOf(std::max({dims.x, dims.y, dims.z})) : 0;
    }
    bool isInGrid() const {
        const glm::ivec3 end = gridEnd();
        for (int axis = 0; axis < 3; ++axis)
            if (finest_[axis] < 0 || finest_[axis] >= end[axis]) return false;
        return true;
    }
    glm::ivec3 placeAt(double t) const {
        const glm::dvec3 at = (ray_.origin + t * ray_.direction) * std::ldexp(1.0, finestLevel());
        return glm::ivec3(glm::floor(glm::clamp(at, glm::dvec3(-1e9), glm::dvec3(1e9))));
    }
    // The empty voxel or leaf that the ray is in.
    std::uint32_t lookUp(CellPlace& place) const {
        CellBlock block = gridBlock(atlas_);
        for (;;) {
            place = {finest_ >> (finestLevel() - block.level), block.level};
            const std::uint32_t word = block.word(place.at);
            if (!isBrick(word)) return word;
            block = brickBlock(atlas_, word, place);
        }
    }
    // Tests what is here and leaps behind what may be left. Returns when the ray gets there.
    double step() {
        CellPlace place;
        std::uint32_t word = lookUp(place);
        if (word & kOccupiedBit) {
            const std::uint32_t* const list = &atlas_.references[leafList(word)];
            std::uint32_t triangle = 0;
            for (ListReader reader(list); reader.read(triangle);) test(triangle);
            word = atlas_.grid.dims.w == kStructureCloud ? 1u : *list;
        }
        return leap(leapBoxOf(atlas_.grid.dims.w, word, place));
    }
    double leap(const CellBox& box) {
        const int finer = finestLevel() - box.level;
        const glm::ivec3 lo = box.lo << finer, hi = ((box.hi + 1) << finer) - 1;
        const double unit = std::ldexp(1.0, -finestLevel());
        double t = kNever;
        int crossed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = ray_.direction[axis];
            if (d == 0.0) continue;
            const double exit = ((d > 0.0 ? hi[axis] + 1 : lo[axis]) * unit - ray_.origin[axis]) / d;
            if (exit >= t) continue;
            t = exit;
            crossed = axis;
        }
        finest_ = glm::clamp(placeAt(t), lo, hi);
        finest_[crossed] = ray_.direction[crossed] > 0.0 ? hi[crossed] + 1 : lo[crossed] - 1;
        return t;
    }
    // Moller & Trumbore 1997.
    void test(std::uint32_t triangle) {
        ++work_.tests;
        const TriangleRecord& record = atlas_.triangles[triangle];
        const glm::dvec3 a = space_.of(record.v0), edge1 = space_.of(record.v1) - a,
                         edge2 = space_.of(record.v2) - a;
        const glm::dvec3 p = glm::cross(ray_.direction, edge2);
        const double determinant = glm::dot(edge1, p);
        if (determinant == 0.0) return;
        const glm::dvec3 s = ray_.origin - a, q = glm::cross(s, edge1);
        const double u = glm::dot(s, p) / determinant, v = glm::dot(ray_.direction, q) / determinant;
        const double t = glm::dot(edge2, q) / determinant;
        if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray_.tMin && t < best_)) return;
        best_ = t;
        hit_ = triangle;
    }

    const Atlas& atlas_;
    Space space_;
    Ray ray_;
    glm::ivec3 finest_{0}; // where the ray is, in voxels of the finest level
    double best_ = kNever;
    std::uint32_t hit_ = kNoHit;
    Work work_;
};

// The numbers of one ray, from its own number alone (SplitMix64: Steele, Lea & Flood 2014).
class Numbers {
public:
    explicit Numbers(std::uint64_t ray) : state_(ray * 0x9E3779B97F4A7C15u) {}
    double unit() {
        std::uint64_t n = state_ += 0x9E3779B97F4A7C15u;
        n = (n ^ (n >> 30)) * 0xBF58476D1CE4E5B9u;
        n = (n ^ (n >> 27)) * 0x94D049BB133111EBu;
        return static_cast<double>((n ^ (n >> 31)) >> 11) * 0x1p-53;
    }
    std::size_t index(std::size_t count) {
        return std::min(count - 1, static_cast<std::size_t>(unit() * static_cast<double>(count)));
    }
    // On the unit sphere.
    glm::dvec3 direction() {
        const double z = 2.0 * unit() - 1.0, angle = 2.0 * std::numbers::pi * unit();
        const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

private:
    std::uint64_t state_;
};

class RayMaker {
public:
    explicit RayMaker(const Atlas& atlas)
        : atlas_(atlas), space_(atlas), size_(atlas.grid.cellSize), dims_(atlas.grid.dims) {}

    // Directions spread evenly in the world, not in voxels, which need not be cubes.
    Ray across(std::uint64_t ray) const {
        Numbers numbers(3 * ray);
        const glm::dvec3 direction = numbers.direction();
        const glm::dvec3 extent = dims_ * size_;
        // A plane across the direction, of which the box hides a part: points outside that miss it.
        const glm::dvec3 u = glm::normalize(
            glm::cross(direction, std::abs(direction.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        const glm::dvec3 v = glm::cross(direction, u);
        const double radius = 0.5 * glm::length(extent);
        for (;;) {
            const glm::dvec3 point =
                0.5 * extent + radius * ((2.0 * numbers.unit() - 1.0) * u + (2.0 * numbers.unit() - 1.0) * v -
                                         2.0 * direction);
            const Ray made{point / size_, direction / size_, 0.0};
            if (meetsGrid(made)) return made;
        }
    }
    Ray towards(std::uint64_t ray) const {
        Numbers numbers(3 * ray + 1);
        const glm::dvec3 target = pointOnTriangle(numbers), direction = numbers.direction() / size_;
        const double far = 2.0 * glm::length(dims_) / glm::length(direction);
        return {target - far * direction, direction, 0.0};
    }
    Ray from(std::uint64_t ray) const {
        Numbers numbers(3 * ray + 2);
        const glm::dvec3 origin = pointOnTriangle(numbers), direction = numbers.direction() / size_;
        return {origin, direction, 1e-9 * glm::length(dims_) / glm::length(direction)};
    }

private:
    bool meetsGrid(const Ray& ray) const {
        double enter = 0.0, leave = kNever;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = ray.direction[axis], o = ray.origin[axis];
            if (d == 0.0 && (o < 0.0 || o > dims_[axis])) return false;
            if (d == 0.0) continue;
            enter = std::max(enter, ((d > 0.0 ? 0.0 : dims_[axis]) - o) / d);
            leave = std::min(leave, ((d > 0.0 ? dims_[axis] : 0.0) - o) / d);
        }
        return enter <= leave;
    }
    glm::dvec3 pointOnTriangle(Numbers& numbers) const {
        const TriangleRecord& t = atlas_.triangles[numbers.index(atlas_.triangles.size())];
        const double root = std::sqrt(numbers.unit()), v = numbers.unit();
        return (1.0 - root) * space_.of(t.v0) + root * (1.0 - v) * space_.of(t.v1) +
               root * v * space_.of(t.v2);
    }

    const Atlas& atlas_;
    Space space_;
    glm::dvec3 size_, dims_;
};

template <class MakeRay>
WorkPerRay meanWork(const Atlas& atlas, const MakeRay& makeRay) {
    using Range = tbb::blocked_range<std::uint64_t>;
    const Work sum = tbb::parallel_reduce(
        Range(0, kRays), Work{},
        [&](const Range& range, Work work) {
            for (std::uint64_t i = range.begin(); i < range.end(); ++i) {
                Walk walk(atlas, makeRay(i));
                walk.run();
                work = work + walk.work();
            }
            return work;
        },
        [](const Work& a, const Work& b) { return a + b; });
    const auto rays = static_cast<double>(kRays);
    return {static_cast<double>(sum.steps) / rays, static_cast<double>(sum.tests) / rays,
            static_cast<double>(sum.hits) / rays};
}

} // namespace

RaySample walkRays(const Atlas& atlas) {
    const RayMaker rays(atlas);
    return {kRays, meanWork(atlas, [&](std::uint64_t i) { return rays.across(i); }),
            meanWork(atlas, [&](std::uint64_t i) { return rays.towards(i); }),
            meanWork(atlas, [&](std::uint64_t i) { return rays.from(i); })};
}

std::uint32_t nearestTriangle(const Atlas& atlas, const glm::dvec3& origin, const glm::dvec3& direction,
                              double tMin) {
    Walk walk(atlas, {origin, direction, tMin});
    walk.run();
    return walk.hit();
}

} // namespace rt
