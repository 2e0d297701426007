#include "tools/rt-grid/rebase_scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt {
namespace {

constexpr int kMaxExponent = 120; // keeps the scale and its inverse normal numbers

// Sterbenz's condition for all pairs of numbers in [lo, hi].
bool subtractsExactly(float lo, float hi) {
    return (lo > 0.0f && double(hi) <= 2.0 * double(lo)) || (hi < 0.0f && double(lo) >= 2.0 * double(hi));
}

} // namespace

Bounds sceneBounds(const Mesh& mesh) {
    using Range = tbb::blocked_range<std::size_t>;
    const auto addRange = [&](const Range& range, Bounds bounds) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (const std::uint32_t vertex : {mesh.triangles[i].x, mesh.triangles[i].y, mesh.triangles[i].z})
                bounds.add(mesh.positions[vertex]);
        return bounds;
    };
    const auto merged = [](Bounds a, const Bounds& b) {
        a.lo = glm::min(a.lo, b.lo);
        a.hi = glm::max(a.hi, b.hi);
        return a;
    };
    const Bounds bounds = tbb::parallel_reduce(Range(0, mesh.triangles.size()), Bounds{}, addRange, merged);
    return {bounds.lo + 0.0f, bounds.hi + 0.0f}; // no -0, which would depend on the order
}

Rebase chooseRebase(const Bounds& bounds) {
    Rebase rebase;
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const float lo = bounds.lo[axis];
        const float hi = bounds.hi[axis];
        largest = std::max(largest, double(hi) - double(lo));
        if (subtractsExactly(lo, hi))
            rebase.offsetWorld[axis] = static_cast<float>(0.5 * (double(lo) + double(hi)));
    }
    if (largest > 0.0) {
        int exponent = 0;
        std::frexp(largest, &exponent);
        rebase.scale = std::ldexp(1.0f, std::clamp(-exponent, -kMaxExponent, kMaxExponent));
    }
    return rebase;
}

namespace {

double sumOfSizes(const glm::dvec3& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

// A float normal, the product of two edges, is off by about 2^-23 of that product, and a hit by its part of
// the triangle's length: by more than 2^-8, where the scene's size is about 1, for these. One without an area
// is never hit.
bool isSliver(const TriangleRecord& t) {
    const glm::dvec3 edge1 = glm::dvec3(t.v1) - glm::dvec3(t.v0), edge2 = glm::dvec3(t.v2) - glm::dvec3(t.v0);
    const double length = std::max(sumOfSizes(edge1), sumOfSizes(edge2));
    const double product = sumOfSizes(edge1) * sumOfSizes(edge2);
    const double area = sumOfSizes(cross(edge1, edge2));
    return area > 0.0 && 0x1p-23 * product * length > 0x1p-8 * area;
}

} // namespace

FreshArray<TriangleRecord> rebaseTriangles(const Mesh& mesh, const Rebase& rebase) {
    FreshArray<TriangleRecord> records(mesh.triangles.size());
    const auto rebased = [&](std::uint32_t vertex, float w) {
        return glm::vec4((mesh.positions[vertex] - rebase.offsetWorld) * rebase.scale, w);
    };
    tbb::parallel_for(std::size_t(0), records.size(), [&](std::size_t i) {
        const glm::uvec3& t = mesh.triangles[i];
        const auto index = std::bit_cast<float>(static_cast<std::uint32_t>(i));
        records[i] = {rebased(t.x, index), rebased(t.y, 0.0f), rebased(t.z, 0.0f)};
        if (isSliver(records[i])) records[i].v1.w = 1.0f;
    });
    return records;
}

} // namespace rt
