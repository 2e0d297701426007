#pragma once
#include "tools/rt-grid/occupancy.h"

#include <array>
#include <cstdint>
#include <vector>

namespace rt {

/// Gives lists their exit boxes: see atlas.shared.h. A box may cover voxels round the leaf's own that are
/// empty or whose lists are subsets of its own. They may be coarser leaves; bricks block where they are not
/// empty. Source: the expanded cells of Perard-Gayot, Kalojanov & Slusallek 2017, "GPU Ray Tracing using
/// Irregular Grids".
class ExitGrower {
public:
    /// The window shows the leaves and `reach` voxels, at most 31, round them; no box goes further. All
    /// arguments must outlive the object. Many threads may grow boxes of different leaves.
    ExitGrower(const NestedOccupancy& occupancy, const OccupancyWindow& window, std::uint32_t* references,
               int reach)
        : occupancy_(occupancy), window_(window), references_(references), reach_(reach) {}

    /// Writes the exit box of the leaf at `voxel` of the window.
    void grow(const glm::ivec3& voxel, std::uint32_t leaf);

private:
    bool tryFace(int face);
    bool mayCover(std::uint32_t word);
    bool holds(std::uint32_t triangle);

    const NestedOccupancy& occupancy_;
    const OccupancyWindow& window_;
    std::uint32_t* references_;
    int reach_;
    std::array<glm::ivec3, 2> corners_; // of the box, both included
    std::vector<std::uint32_t> list_;   // of the leaf
    std::uint64_t signature_ = 0;       // bit i: whether the list has a triangle that is i modulo 64
    std::size_t found_ = 0;             // place in the list of the last triangle that holds() was asked for
    std::uint32_t covered_ = 0;         // the last leaf that the box may cover: coarser ones are met again
};

} // namespace rt
