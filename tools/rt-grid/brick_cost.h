#pragma once
#include "formats/atlas.shared.h"

#include <glm/vec3.hpp>
#include <span>

namespace rt {

inline constexpr double kReferencesPerLeaf = 3.0; ///< what bricks of statues and interiors come to

/// How many voxels the triangles of one voxel meet when it is divided: corners + edges * side + area * side^2
/// for side^3 voxels. A triangle of perimeter p and area A meets 1 + 3/4 p + 3/2 A voxels of side 1 on
/// average over its positions and rotations (the kinematic formula: Santalo 1976), and as it lies in other
/// voxels too, each of them has its share of the three terms.
struct Spread {
    float corners = 0.0f;
    float edges = 0.0f;
    float area = 0.0f;

    /// The share of one triangle in each voxel that it meets; the terms add up to 1.
    static Spread of(const TriangleRecord& triangle, const glm::vec3& voxelsPerUnit);
    double references(double side) const { return corners + side * (edges + side * area); }
};

/// Where voxels become bricks, and of how many voxels, so that a ray's tests and steps and the words of
/// memory together cost least.
class BrickCost {
public:
    /// wordCost: steps that a ray through a voxel of the grid must save for each word of memory.
    /// finestLevel: no voxel may be finer. `triangles` must outlive the object.
    BrickCost(std::span<const TriangleRecord> triangles, const glm::vec3& cellsPerUnit, double wordCost,
              int finestLevel)
        : triangles_(triangles), cellsPerUnit_(cellsPerUnit), wordCost_(wordCost), finestLevel_(finestLevel) {
    }

    /// k of the (2^k)^3 voxels of the brick that a voxel of `level` with these triangles is worth, at most
    /// kMaxBrickShift; 0: it had better be a leaf.
    int shiftFor(std::span<const std::uint32_t> list, int level) const;

    /// Of all triangles of the list in a voxel of `level`, from a sample of them.
    Spread spreadOf(std::span<const std::uint32_t> list, int level) const;

private:
    std::span<const TriangleRecord> triangles_;
    glm::vec3 cellsPerUnit_;
    double wordCost_;
    int finestLevel_;
};

} // namespace rt
