#include "tools/rt-grid/choose_structure.h"

#include "tools/rt-grid/brick_cost.h"

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr std::uint64_t kMostVoxels = 4096;

double surfaceOf(const glm::dvec3& size) {
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

// In a voxel divided into side^3: the ray meets each part with probability side^-2, and what is empty between
// them costs a step.
WorkForecast dividedWork(const Spread& spread, double side) {
    const double references = spread.references(side);
    return {1.0 + references / kReferencesPerLeaf / (side * side), references / (side * side)};
}

WorkForecast nestedWork(const BrickCost& cost, std::span<const std::uint32_t> list, const Spread& spread,
                        const NestOptions& options) {
    const int shift = list.size() <= options.gridLeafSize ? 0 : cost.shiftFor(list, 0);
    if (shift == 0) return {1.0, static_cast<double>(list.size())};
    WorkForecast work = dividedWork(spread, 1 << shift);
    work.steps += 1.0; // to look into the brick
    return work;
}

void add(WorkForecast& sum, const WorkForecast& work, double weight) {
    sum.steps += weight * work.steps;
    sum.tests += weight * work.tests;
}

} // namespace

StructureChoice chooseStructure(const CellRefs& cells, std::span<const TriangleRecord> triangles,
                                const GridLayout& layout, const NestOptions& options, double octantVoxels) {
    const BrickCost cost(triangles, layout.cellsPerUnit, options.wordCost,
                         finestLevelOf(std::max({layout.dims.x, layout.dims.y, layout.dims.z})));
    const glm::dvec3 cellSize(layout.cellSize);
    const double chance = surfaceOf(cellSize) / surfaceOf(cellSize * glm::dvec3(layout.dims));
    const std::uint64_t stride = std::max<std::uint64_t>(1, cells.occupiedVoxels / kMostVoxels);
    const double octantSide = std::max(1.0, std::cbrt(octantVoxels));
    StructureChoice choice;
    std::vector<std::uint32_t> list;
    std::uint64_t next = 0; // of the occupied voxels
    for (const std::uint32_t word : cells.voxels) {
        if (word == 0 || next++ % stride != 0) continue;
        copyTriangles(cells.references, leafList(word), list);
        const Spread spread = cost.spreadOf(list, 0);
        const double aimed = static_cast<double>(list.size()) / static_cast<double>(cells.referenceCount);
        const double weight = 0.5 * (chance + aimed) * static_cast<double>(stride);
        add(choice.nested, nestedWork(cost, list, spread, options), weight);
        add(choice.octant, dividedWork(spread, octantSide), weight);
    }
    if (choice.octant.cost() < choice.nested.cost()) choice.structure = kStructureOctant;
    return choice;
}

} // namespace rt
