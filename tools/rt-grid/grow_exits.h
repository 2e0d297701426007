#pragma once
#include "tools/rt-grid/occupancy.h"

#include <array>
#include <cstdint>
#include <vector>

namespace rt {

/// Gives lists their exit boxes: see atlas.shared.h. A box may cover voxels round the leaf's own that are
/// empty, or leaves of the same block whose lists are subsets of its own. Leaves of other blocks block: to
/// cover them too takes several times as long for a twentieth of the gain. Source: the expanded cells of
/// Perard-Gayot, Kalojanov & Slusallek 2017, "GPU Ray Tracing using Irregular Grids".
class ExitGrower {
public:
    /// The window shows the leaves to be grown and `reach` voxels, at most 31, round them; no box goes
    /// further. All arguments must outlive the object.
    ExitGrower(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references, int reach);

    /// Writes the exit box of the leaf at `voxel` of the window; it must be in the block.
    void grow(const glm::ivec3& voxel);

private:
    template <int kAxis, bool kUp>
    bool tryFace();
    bool mayCover(const glm::ivec3& voxel) const;
    std::size_t indexOf(const glm::ivec3& inBlock) const {
        return static_cast<std::size_t>((inBlock.z * block_.size.y + inBlock.y) * block_.size.x + inBlock.x);
    }

    const OccupancyWindow& window_;
    const VoxelBlock& block_;
    std::uint32_t* references_;
    int reach_;
    glm::ivec3 lo_{0}, hi_{0};    // the box, both included
    std::uint64_t signature_ = 0; // of the leaf
    const std::uint32_t* list_ = nullptr;
    // Of the voxels of the block: 0 if empty, all bits of a brick, and bit i of a leaf if its list has a
    // triangle that is i modulo 64. Most lists that are no subsets show it.
    std::vector<std::uint64_t> signatures_;
};

} // namespace rt
