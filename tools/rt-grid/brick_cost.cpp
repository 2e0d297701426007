#include "tools/rt-grid/brick_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace rt {
namespace {

constexpr std::size_t kLargestSample = 6; // triangles of a list that are looked at
constexpr double kBrickWords = 48.0;      // what building a brick costs beyond its words: see README.md
constexpr double kLongList = 400.0;       // triangles times 2^level from which on words are cheap

struct Cost {
    double work; // steps and tests of a ray, a test counted like a step
    double words;
};

Cost costOfLeaf(double count) {
    return {1.0 + count, kListHeaderWords + count};
}

// A ray that meets the voxel meets one of its side^3 parts with probability side^-2.
constexpr std::array<double, kMaxBrickShift + 1> kChance{1.0, 0x1p-2, 0x1p-4, 0x1p-6, 0x1p-8, 0x1p-10};

Cost costOfBrick(const Spread& spread, int shift) {
    const double side = 1 << shift;
    const double references = spread.references(side);
    const double leaves = references * (1.0 / kReferencesPerLeaf);
    return {2.0 + (leaves + references) * kChance[static_cast<std::size_t>(shift)],
            kBrickWords + side * side * side + kListHeaderWords * leaves + references};
}

} // namespace

Spread Spread::of(const TriangleRecord& triangle, const glm::vec3& voxelsPerUnit) {
    const glm::vec3 a = glm::vec3(triangle.v1 - triangle.v0) * voxelsPerUnit;
    const glm::vec3 b = glm::vec3(triangle.v2 - triangle.v0) * voxelsPerUnit;
    const float edges = 0.75f * (glm::length(a) + glm::length(b) + glm::length(a - b));
    const float area = 0.75f * glm::length(glm::cross(a, b));
    const float share = 1.0f / (1.0f + edges + area);
    return {share, share * edges, share * area};
}

Spread BrickCost::spreadOf(std::span<const std::uint32_t> list, int level) const {
    const glm::vec3 voxelsPerUnit = cellsPerUnit_ * std::ldexp(1.0f, level);
    const std::size_t stride = (list.size() + kLargestSample - 1) / kLargestSample;
    Spread spread;
    for (std::size_t i = 0; i < list.size(); i += stride) {
        const Spread one = Spread::of(triangles_[list[i]], voxelsPerUnit);
        spread.corners += one.corners;
        spread.edges += one.edges;
        spread.area += one.area;
    }
    const auto count = static_cast<float>(list.size());
    const float perSample = count / (spread.corners + spread.edges + spread.area);
    return {spread.corners * perSample, spread.edges * perSample, spread.area * perSample};
}

int BrickCost::shiftFor(std::span<const std::uint32_t> list, int level) const {
    const Spread spread = spreadOf(list, level);
    const auto count = static_cast<float>(list.size());
    // Of all rays in the scene 4^-level meet a voxel, but people look at where the detail is. Half the
    // exponent does well indoors and for a teapot in a stadium; a long list gets its few words per triangle
    // however deep it is.
    const double wordCost = std::min(std::ldexp(wordCost_, level), wordCost_ * kLongList / count);
    const auto total = [&](const Cost& cost) { return cost.work + wordCost * cost.words; };
    int best = 0;
    double least = total(costOfLeaf(count));
    for (int shift = 1; shift <= std::min(int(kMaxBrickShift), finestLevel_ - level); ++shift) {
        const double cost = total(costOfBrick(spread, shift));
        if (cost < least) best = shift;
        least = std::min(cost, least);
    }
    return best;
}

} // namespace rt
