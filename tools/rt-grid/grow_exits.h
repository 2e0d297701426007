#pragma once
#include "tools/rt-grid/occupancy.h"

#include <array>
#include <cstdint>
#include <vector>

namespace rt {

/// Gives the lists of a block's leaves their exit boxes, block after block in the same memory: see
/// atlas.shared.h. A box grows over voxels that are empty, and from one leaf to the next where that lists
/// nothing new. Boxes reach up to `reach` voxels beyond the leaf, at most 31; the window shows so many round
/// the block.
/// Source: the expanded cells of Perard-Gayot, Kalojanov & Slusallek 2017, "GPU Ray Tracing using Irregular
/// Grids".
class ExitGrower {
public:
    /// Of steps between leaves only those are known that the lists' headers name (LeafRelations), so that
    /// lists beyond a brick stop boxes: to look them up too takes longer than all the rest, for a tenth of
    /// the gain.
    void grow(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references, int reach);

    /// All steps between leaves of the block `known` are found in the lists. It holds the other block and
    /// goes less than `reach` voxels beyond it.
    void grow(const OccupancyWindow& window, const VoxelBlock& block, const VoxelBlock& known,
              std::uint32_t* references, int reach);

    /// Bit x of a row of voxels: whether boxes may not step from voxel x over that face. Faces: x down, x up,
    /// y down, ...
    using FaceRows = std::array<std::uint64_t, 6>;

private:
    struct Leaf {
        glm::ivec3 voxel; // of the block
        std::uint32_t list;
    };
    void begin(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references, int reach);
    void blockByOccupancy();
    void findLeaves();
    void openNamed();
    void openByLists();
    void open(const glm::ivec3& voxel, int face);
    void growAll(const VoxelBlock& block);
    std::ptrdiff_t rowsPerSlice() const { return last_.y - first_.y + 1; }
    // Where a voxel of the block is found in faces_.
    glm::ivec3 placeOf(const glm::ivec3& voxel) const {
        return block_->first + voxel - glm::ivec3(0, first_.y, first_.z);
    }

    const OccupancyWindow* window_ = nullptr;
    const VoxelBlock* block_ = nullptr;
    std::uint32_t* references_ = nullptr;
    int reach_ = 0;
    glm::ivec3 first_{0}, last_{0}; // voxels of the window from which boxes may step on
    std::vector<FaceRows> faces_;   // of their rows
    std::vector<Leaf> leaves_;      // of the block, x fastest
};

} // namespace rt
