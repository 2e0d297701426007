#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/lanes.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace rt {

/// One bit per word: whether it is occupied. Reading them is what many threads may do while the words of
/// empty voxels are being written.
class OccupancyBits {
public:
    explicit OccupancyBits(std::span<const std::uint32_t> words);
    /// 57 bits or more from `index` on, the first one lowest; those beyond the last word are 0.
    std::uint64_t from(std::size_t index) const {
        std::uint64_t bits;
        std::memcpy(&bits, bytes_.data() + (index >> 3), sizeof bits);
        return bits >> (index & 7);
    }
    bool at(std::size_t index) const { return (bytes_[index >> 3] >> (index & 7)) & 1; }

private:
    std::vector<std::uint8_t> bytes_; // and eight zero bytes
};

/// What the growth of boxes reads: the words of occupied voxels, and which those are.
struct NestedOccupancy {
    glm::ivec3 dims{1};
    std::span<const std::uint32_t> voxels;
    std::span<const std::uint32_t> bricks;
    OccupancyBits voxelBits;
    OccupancyBits brickBits;

    std::size_t indexOf(const glm::ivec3& voxel) const {
        return (static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(dims.y) +
                static_cast<std::size_t>(voxel.y)) *
                   static_cast<std::size_t>(dims.x) +
               static_cast<std::size_t>(voxel.x);
    }
};

/// A block of voxels of one size, side by side in memory along x.
struct VoxelBlock {
    std::uint32_t* words;
    glm::ivec3 size;
    std::ptrdiff_t rowStride;
    std::ptrdiff_t sliceStride;
    glm::ivec3 first; ///< where the block begins in a window

    std::uint32_t* word(const glm::ivec3& voxel) const {
        return words + voxel.z * sliceStride + voxel.y * rowStride + voxel.x;
    }
};

/// Which voxels of one level are occupied in a cube of up to 64^3 of them, whatever the levels of the bricks
/// there. Outside the grid nothing is.
class OccupancyWindow {
public:
    static constexpr int kLargestSide = 64;

    /// Shows the voxels of `level` from `first` on.
    void show(const NestedOccupancy& occupancy, int level, const glm::ivec3& first, int side);

    int side() const { return side_; }
    /// Bit x of row (y, z): whether the voxel is occupied.
    std::uint64_t row(int y, int z) const { return rows_[index(y, z)]; }
    /// The rows of a block, all in one.
    std::uint64_t rowsIn(int y0, int y1, int z0, int z1) const {
        BitLanes bits{};
        const std::uint64_t* line = &rows_[index(y0, z0)];
        const int lastFour = y1 - y0 - 3;
        if (lastFour < 0) {
            for (int z = z0; z <= z1; ++z, line += side_) bits |= fourRows(line);
            bits &= kFirstLanes[y1 - y0];
        } else {
            for (int z = z0; z <= z1; ++z, line += side_) {
                for (int y = 0; y < lastFour; y += 4) bits |= fourRows(line + y);
                bits |= fourRows(line + lastFour);
            }
        }
        return static_cast<std::uint64_t>(bits[0] | bits[1] | bits[2] | bits[3]);
    }

private:
    struct Clip {
        glm::ivec3 lo, hi; // rows and bits of the window, both included
        bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
    };
    RT_LANES_ALIGNED static constexpr BitLanes kFirstLanes[3] = {
        {-1, 0, 0, 0}, {-1, -1, 0, 0}, {-1, -1, -1, 0}};
    static BitLanes fourRows(const std::uint64_t* rows) {
        BitLanes four;
        std::memcpy(&four, rows, sizeof four);
        return four;
    }
    std::size_t index(int y, int z) const { return static_cast<std::size_t>(z * side_ + y); }
    Clip clipOf(const glm::ivec3& voxel, int voxelLevel) const;
    void showGrid(const NestedOccupancy& occupancy);
    void fill(const Clip& clip);
    void paint(const NestedOccupancy& occupancy, std::uint32_t word, const glm::ivec3& voxel, int voxelLevel);
    void paintFiner(const NestedOccupancy& occupancy, std::uint32_t word, const glm::ivec3& origin, int finer,
                    const Clip& clip);
    void paintCoarser(const NestedOccupancy& occupancy, std::uint32_t word, const glm::ivec3& voxel,
                      int voxelLevel, const Clip& clip);

    int level_ = 0;
    int side_ = 0;
    glm::ivec3 first_{0};
    std::array<std::uint64_t, kLargestSide * kLargestSide + 3> rows_; // four may be read from any on
};

} // namespace rt
