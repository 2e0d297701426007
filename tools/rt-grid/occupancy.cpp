#include "tools/rt-grid/occupancy.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace rt {
namespace {

std::uint64_t lowBits(int count) {
    return count >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << count) - 1;
}

// Bit i of the result: whether any of the 2^shift bits from i * 2^shift on is set.
std::uint64_t anyOfGroups(std::uint64_t bits, int shift, int groups) {
    if (shift == 0 || bits == 0) return bits;
    std::uint64_t result = 0;
    const std::uint64_t group = lowBits(1 << shift);
    for (int i = 0; i < groups; ++i) result |= std::uint64_t((bits >> (i << shift) & group) != 0) << i;
    return result;
}

std::uint64_t shifted(std::uint64_t bits, int by) {
    return by >= 0 ? bits << by : bits >> -by;
}

} // namespace

OccupancyBits::OccupancyBits(std::span<const std::uint32_t> words) : bytes_((words.size() + 7) / 8 + 8) {
    using Range = tbb::blocked_range<std::size_t>;
    tbb::parallel_for(Range(0, (words.size() + 7) / 8, 4096), [&](const Range& range) {
        for (std::size_t byte = range.begin(); byte < range.end(); ++byte) {
            const std::size_t last = std::min(words.size(), byte * 8 + 8);
            unsigned bits = 0;
            for (std::size_t i = byte * 8; i < last; ++i) bits |= (words[i] >> 31) << (i & 7);
            bytes_[byte] = static_cast<std::uint8_t>(bits);
        }
    });
}

void OccupancyWindow::show(const NestedOccupancy& occupancy, int level, const glm::ivec3& first, int side) {
    level_ = level;
    side_ = side;
    first_ = first;
    std::fill_n(rows_.begin(), side * side, std::uint64_t(0));
    if (level == 0) return showGrid(occupancy);
    const glm::ivec3 lo = glm::max(first >> level, glm::ivec3(0));
    const glm::ivec3 hi = glm::min((first + (side - 1)) >> level, occupancy.dims - 1);
    for (int z = lo.z; z <= hi.z; ++z)
        for (int y = lo.y; y <= hi.y; ++y)
            for (int x = lo.x; x <= hi.x; ++x) {
                const std::size_t i = occupancy.indexOf({x, y, z});
                if (occupancy.voxelBits.at(i)) paint(occupancy, occupancy.voxels[i], {x, y, z}, 0);
            }
}

void OccupancyWindow::showGrid(const NestedOccupancy& occupancy) {
    const glm::ivec3 lo = glm::max(first_, glm::ivec3(0));
    const glm::ivec3 hi = glm::min(first_ + side_, occupancy.dims); // not included
    for (int z = lo.z; z < hi.z; ++z)
        for (int y = lo.y; y < hi.y; ++y) {
            const std::size_t i = occupancy.indexOf({lo.x, y, z});
            const int half = std::min(32, hi.x - lo.x);
            std::uint64_t bits = occupancy.voxelBits.from(i) & lowBits(half);
            if (half == 32) bits |= (occupancy.voxelBits.from(i + 32) & lowBits(hi.x - lo.x - 32)) << 32;
            rows_[index(y - first_.y, z - first_.z)] = bits << (lo.x - first_.x);
        }
}

OccupancyWindow::Clip OccupancyWindow::clipOf(const glm::ivec3& voxel, int voxelLevel) const {
    const int coarser = level_ - voxelLevel;
    const glm::ivec3 lo = (voxel << coarser) - first_;
    return {glm::max(lo, glm::ivec3(0)), glm::min(lo + ((1 << coarser) - 1), glm::ivec3(side_ - 1))};
}

void OccupancyWindow::fill(const Clip& clip) {
    const std::uint64_t bits = lowBits(clip.hi.x - clip.lo.x + 1) << clip.lo.x;
    for (int z = clip.lo.z; z <= clip.hi.z; ++z)
        for (int y = clip.lo.y; y <= clip.hi.y; ++y) rows_[index(y, z)] |= bits;
}

// `word` is occupied and its voxel not finer than those of the window.
void OccupancyWindow::paint(const NestedOccupancy& occupancy, std::uint32_t word, const glm::ivec3& voxel,
                            int voxelLevel) {
    const Clip clip = clipOf(voxel, voxelLevel);
    if (clip.empty()) return;
    if (voxelLevel == level_ || !isBrick(word)) return fill(clip);
    const int finer = voxelLevel + brickShift(word) - level_;
    if (finer >= 0)
        paintFiner(occupancy, word, (voxel << (level_ - voxelLevel)) - first_, finer, clip);
    else
        paintCoarser(occupancy, word, voxel, voxelLevel, clip);
}

// The brick's voxels are 2^finer times finer than the window's; `origin` is where it begins in the window.
void OccupancyWindow::paintFiner(const NestedOccupancy& occupancy, std::uint32_t word,
                                 const glm::ivec3& origin, int finer, const Clip& clip) {
    const int shift = brickShift(word);
    const std::size_t offset = brickOffset(word);
    const std::uint64_t mask = lowBits(1 << shift);
    for (int z = clip.lo.z; z <= clip.hi.z; ++z)
        for (int y = clip.lo.y; y <= clip.hi.y; ++y) {
            std::uint64_t bits = 0;
            const int brickY = (y - origin.y) << finer;
            const int brickZ = (z - origin.z) << finer;
            for (int dz = 0; dz < 1 << finer; ++dz)
                for (int dy = 0; dy < 1 << finer; ++dy)
                    bits |= occupancy.brickBits.from(
                        offset + static_cast<std::size_t>((((brickZ + dz) << shift) + brickY + dy) << shift));
            rows_[index(y, z)] |= shifted(anyOfGroups(bits & mask, finer, 1 << (shift - finer)), origin.x);
        }
}

void OccupancyWindow::paintCoarser(const NestedOccupancy& occupancy, std::uint32_t word,
                                   const glm::ivec3& voxel, int voxelLevel, const Clip& clip) {
    const int shift = brickShift(word);
    const int level = voxelLevel + shift;
    const std::size_t offset = brickOffset(word);
    const glm::ivec3 brick = voxel << shift;
    const glm::ivec3 lo = ((clip.lo + first_) >> (level_ - level)) - brick;
    const glm::ivec3 hi = ((clip.hi + first_) >> (level_ - level)) - brick;
    for (int z = lo.z; z <= hi.z; ++z)
        for (int y = lo.y; y <= hi.y; ++y) {
            const std::size_t row = offset + static_cast<std::size_t>(((z << shift) + y) << shift);
            std::uint64_t bits = occupancy.brickBits.from(row) & (lowBits(hi.x - lo.x + 1) << lo.x);
            for (; bits != 0; bits &= bits - 1) {
                const int x = std::countr_zero(bits);
                paint(occupancy, occupancy.bricks[row + static_cast<std::size_t>(x)],
                      brick + glm::ivec3(x, y, z), level);
            }
        }
}

} // namespace rt
