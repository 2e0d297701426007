#include "tools/rt-grid/grow_exits.h"

#include "tools/rt-grid/lanes.h"
#include "tools/rt-grid/triangle_lists.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/vector_relational.hpp>
#include <vector>

namespace rt {
namespace {

std::uint64_t signatureOf(ListReader list) {
    std::uint64_t signature = 0;
    for (std::uint32_t triangle = 0; list.read(triangle);) signature |= std::uint64_t(1) << (triangle & 63);
    return signature;
}

using FaceRows = ExitGrower::FaceRows;

class ExitBox {
public:
    // rows: those of z = 0, one after the other, before those of z = 1.
    ExitBox(const FaceRows* rows, std::ptrdiff_t stride, const glm::ivec3& voxel)
        : rows_(rows), stride_(stride), lo_(voxel), hi_(voxel), across_(row(voxel.y, voxel.z)) {}

    // How far beyond the voxel the box reaches on each side.
    std::uint32_t grow(int reach) {
        const glm::ivec3 voxel = lo_;
        unsigned moving = 0; // bit i: over face i
        for (unsigned face = 0; face < 6; ++face)
            moving |= static_cast<unsigned>(~across_[face] >> voxel.x & 1) << face;
        for (int i = 0; i < reach && moving != 0; ++i) {
            if (moving & 1 && !stepX<0>()) moving &= ~1u;
            if (moving & 2 && !stepX<1>()) moving &= ~2u;
            if (moving & 4 && !step<1, 0>()) moving &= ~4u;
            if (moving & 8 && !step<1, 1>()) moving &= ~8u;
            if (moving & 16 && !step<2, 0>()) moving &= ~16u;
            if (moving & 32 && !step<2, 1>()) moving &= ~32u;
        }
        return freeBoxWord(voxel - lo_, hi_ - voxel);
    }

private:
    const FaceRows& row(int y, int z) const { return rows_[z * stride_ + y]; }

    // Each moves a face by one voxel if the box may step over it everywhere.
    template <int kUp>
    bool stepX() {
        if (across_[kUp] >> (kUp ? hi_ : lo_).x & 1) return false;
        (kUp ? hi_ : lo_).x += 2 * kUp - 1;
        return true;
    }
    template <int kAxis, int kUp>
    bool step() {
        constexpr int kOther = 3 - kAxis; // the rows of the face stand side by side along this axis
        const std::ptrdiff_t stride = kOther == 1 ? 1 : stride_;
        const int count = hi_[kOther] - lo_[kOther] + 1;
        glm::ivec3 first = lo_;
        first[kAxis] = (kUp ? hi_ : lo_)[kAxis];
        std::uint64_t blocked = 0;
        const FaceRows* rows = &row(first.y, first.z);
        for (int i = 0; i < count; ++i, rows += stride) blocked |= (*rows)[2 * kAxis + kUp];
        if (blocked & (~std::uint64_t(0) >> (63 - (hi_.x - lo_.x))) << lo_.x) return false;
        (kUp ? hi_ : lo_)[kAxis] = first[kAxis] += 2 * kUp - 1;
        rows = &row(first.y, first.z);
        for (int i = 0; i < count; ++i, rows += stride) {
            across_[0] |= (*rows)[0];
            across_[1] |= (*rows)[1];
        }
        return true;
    }

    const FaceRows* rows_;
    std::ptrdiff_t stride_;
    glm::ivec3 lo_, hi_; // both included
    FaceRows across_;    // x down and x up of all rows of the box in one
};

} // namespace

RT_WIDE_LANES void ExitGrower::begin(const OccupancyWindow& window, const VoxelBlock& block,
                                     std::uint32_t* references, int reach) {
    window_ = &window;
    block_ = &block;
    references_ = references;
    reach_ = reach;
    first_ = glm::max(block.first - reach, glm::ivec3(0));
    last_ = glm::min(block.first + block.size - 1 + reach, glm::ivec3(window.side() - 1));
    blockByOccupancy();
    findLeaves();
}

void ExitGrower::open(const glm::ivec3& voxel, int face) {
    const glm::ivec3 place = placeOf(voxel);
    FaceRows& row = faces_[static_cast<std::size_t>(place.z * rowsPerSlice() + place.y)];
    row[static_cast<std::size_t>(face)] &= ~(std::uint64_t(1) << place.x);
}

void ExitGrower::blockByOccupancy() {
    const auto count = static_cast<std::size_t>((last_.z - first_.z + 1) * rowsPerSlice());
    if (faces_.size() < count) faces_.resize(count);
    FaceRows* rows = faces_.data();
    for (int z = first_.z; z <= last_.z; ++z) {
        const int below = std::max(z - 1, first_.z); // no box steps out of the rows that there are
        const int above = std::min(z + 1, last_.z);
        for (int y = first_.y; y <= last_.y; ++y)
            *rows++ = {window_->row(y, z) << 1,
                       window_->row(y, z) >> 1,
                       window_->row(std::max(y - 1, first_.y), z),
                       window_->row(std::min(y + 1, last_.y), z),
                       window_->row(y, below),
                       window_->row(y, above)};
    }
}

void ExitGrower::findLeaves() {
    leaves_.clear();
    const glm::ivec3& size = block_->size;
    const std::uint64_t columns = ~std::uint64_t(0) >> (64 - size.x);
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y) {
            std::uint64_t occupied =
                window_->row(y + block_->first.y, z + block_->first.z) >> block_->first.x & columns;
            for (; occupied != 0; occupied &= occupied - 1) {
                const glm::ivec3 voxel(std::countr_zero(occupied), y, z);
                const std::uint32_t word = *block_->word(voxel);
                if (!isBrick(word)) leaves_.push_back({voxel, leafList(word)});
            }
        }
}

void ExitGrower::openNamed() {
    for (const Leaf& leaf : leaves_)
        for (std::uint32_t faces = references_[leaf.list]; faces != 0; faces &= faces - 1)
            open(leaf.voxel, std::countr_zero(faces));
}

void ExitGrower::openByLists() {
    const glm::ivec3& size = block_->size;
    std::vector<const Leaf*> leafAt(static_cast<std::size_t>(size.x * size.y * size.z)); // or none
    std::vector<std::uint64_t> signatures;
    const auto indexOf = [&](const glm::ivec3& v) {
        return static_cast<std::size_t>((v.z * size.y + v.y) * size.x + v.x);
    };
    for (const Leaf& leaf : leaves_) {
        leafAt[indexOf(leaf.voxel)] = &leaf;
        signatures.push_back(signatureOf(ListReader(references_ + leaf.list)));
    }
    const auto listsAll = [&](const Leaf& leaf, const Leaf& other) {
        if (signatures[&other - leaves_.data()] & ~signatures[&leaf - leaves_.data()]) return false;
        return isSubset(ListReader(references_ + other.list), ListReader(references_ + leaf.list));
    };
    for (const Leaf& leaf : leaves_)
        for (int axis = 0; axis < 3; ++axis) {
            glm::ivec3 next = leaf.voxel;
            if (++next[axis] == size[axis]) continue;
            const Leaf* const above = leafAt[indexOf(next)];
            if (!above) continue;
            if (listsAll(leaf, *above)) open(leaf.voxel, 2 * axis + 1);
            if (listsAll(*above, leaf)) open(next, 2 * axis);
        }
}

RT_WIDE_LANES void ExitGrower::growAll(const VoxelBlock& block) {
    const glm::ivec3 lo = block.first - block_->first;
    const glm::ivec3 hi = lo + block.size;
    for (const Leaf& leaf : leaves_) {
        if (glm::any(glm::lessThan(leaf.voxel, lo)) || glm::any(glm::greaterThanEqual(leaf.voxel, hi)))
            continue;
        references_[leaf.list] = ExitBox(faces_.data(), rowsPerSlice(), placeOf(leaf.voxel)).grow(reach_);
    }
}

void ExitGrower::grow(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references,
                      int reach) {
    if (reach == 0) return;
    begin(window, block, references, reach);
    openNamed();
    growAll(block);
}

void ExitGrower::grow(const OccupancyWindow& window, const VoxelBlock& block, const VoxelBlock& known,
                      std::uint32_t* references, int reach) {
    if (reach == 0) return;
    begin(window, known, references, reach);
    openByLists();
    growAll(block);
}

} // namespace rt
