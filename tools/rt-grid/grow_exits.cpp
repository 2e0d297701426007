#include "tools/rt-grid/grow_exits.h"

#include "tools/rt-grid/triangle_lists.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <vector>

namespace rt {
namespace {

std::uint64_t signatureOf(ListReader list) {
    std::uint64_t signature = 0;
    for (std::uint32_t triangle = 0; list.read(triangle);) signature |= std::uint64_t(1) << (triangle & 63);
    return signature;
}

// Bit x of a row of voxels: whether boxes may not step from voxel x over that face. Faces: x down, x up, y
// down, ...
using FaceRows = std::array<std::uint64_t, 6>;

class ExitBox {
public:
    // rows: those of z = 0, one after the other, before those of z = 1.
    ExitBox(const FaceRows* rows, std::ptrdiff_t stride, const glm::ivec3& voxel)
        : rows_(rows), stride_(stride), lo_(voxel), hi_(voxel), across_(row(voxel.y, voxel.z)) {}

    // How far beyond the voxel the box reaches on each side.
    std::uint32_t grow(int reach) {
        const glm::ivec3 voxel = lo_;
        std::array<bool, 6> grows;
        for (std::size_t face = 0; face < 6; ++face) grows[face] = !(across_[face] >> voxel.x & 1);
        for (int i = 0; i < reach; ++i) {
            grows[0] = grows[0] && stepX<0>();
            grows[1] = grows[1] && stepX<1>();
            grows[2] = grows[2] && step<1, 0>();
            grows[3] = grows[3] && step<1, 1>();
            grows[4] = grows[4] && step<2, 0>();
            grows[5] = grows[5] && step<2, 1>();
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

class ExitGrower {
public:
    ExitGrower(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references, int reach);

    void growAll(const VoxelBlock& block);

private:
    void blockByOccupancy();
    void readLists();
    void relateLists();
    void relate(const glm::ivec3& lower, int axis);

    std::ptrdiff_t rowsPerSlice() const { return last_.y - first_.y + 1; }
    // Where a voxel of the block is found in faces_.
    glm::ivec3 placeOf(const glm::ivec3& voxel) const {
        return block_.first + voxel - glm::ivec3(0, first_.y, first_.z);
    }
    std::size_t indexOf(const glm::ivec3& inBlock) const {
        return static_cast<std::size_t>((inBlock.z * block_.size.y + inBlock.y) * block_.size.x + inBlock.x);
    }

    const OccupancyWindow& window_;
    const VoxelBlock& block_;
    std::uint32_t* references_;
    int reach_;
    glm::ivec3 first_, last_;             // voxels of the window from which boxes may step on
    std::unique_ptr<FaceRows[]> faces_;   // of their rows
    std::vector<std::uint64_t> leafRows_; // of the block: bit x is set where there is a leaf
    std::unique_ptr<std::uint64_t[]>
        signatures_; // of its leaves: bit i is set for triangles that are i modulo 64
};

ExitGrower::ExitGrower(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references,
                       int reach)
    : window_(window), block_(block), references_(references), reach_(reach),
      first_(glm::max(block.first - reach, glm::ivec3(0))),
      last_(glm::min(block.first + block.size - 1 + reach, glm::ivec3(window.side() - 1))) {
    blockByOccupancy();
    readLists();
    relateLists();
}

void ExitGrower::blockByOccupancy() {
    faces_ = std::make_unique_for_overwrite<FaceRows[]>(
        static_cast<std::size_t>((last_.z - first_.z + 1) * rowsPerSlice()));
    FaceRows* rows = faces_.get();
    for (int z = first_.z; z <= last_.z; ++z) {
        const int below = std::max(z - 1, first_.z); // no box steps out of the rows that there are
        const int above = std::min(z + 1, last_.z);
        for (int y = first_.y; y <= last_.y; ++y)
            *rows++ = {window_.row(y, z) << 1,
                       window_.row(y, z) >> 1,
                       window_.row(std::max(y - 1, first_.y), z),
                       window_.row(std::min(y + 1, last_.y), z),
                       window_.row(y, below),
                       window_.row(y, above)};
    }
}

void ExitGrower::readLists() {
    const glm::ivec3& size = block_.size;
    const std::uint64_t columns = ~std::uint64_t(0) >> (64 - size.x);
    signatures_ = std::make_unique_for_overwrite<std::uint64_t[]>(indexOf({0, 0, size.z}));
    leafRows_.reserve(static_cast<std::size_t>(size.y * size.z));
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y) {
            const std::uint64_t occupied =
                window_.row(y + block_.first.y, z + block_.first.z) >> block_.first.x & columns;
            std::uint64_t leaves = occupied;
            for (std::uint64_t bits = occupied; bits != 0; bits &= bits - 1) {
                const glm::ivec3 voxel(std::countr_zero(bits), y, z);
                const std::uint32_t word = *block_.word(voxel);
                if (isBrick(word))
                    leaves &= ~(bits & -bits);
                else
                    signatures_[indexOf(voxel)] = signatureOf(ListReader(references_ + leafList(word)));
            }
            leafRows_.push_back(leaves);
        }
}

void ExitGrower::relateLists() {
    const glm::ivec3& size = block_.size;
    const std::uint64_t* leaves = leafRows_.data();
    const auto relateAll = [&](std::uint64_t pairs, int y, int z, int axis) {
        for (; pairs != 0; pairs &= pairs - 1) relate({std::countr_zero(pairs), y, z}, axis);
    };
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y, ++leaves) {
            relateAll(leaves[0] & leaves[0] >> 1, y, z, 0);
            if (y + 1 < size.y) relateAll(leaves[0] & leaves[1], y, z, 1);
            if (z + 1 < size.z) relateAll(leaves[0] & leaves[size.y], y, z, 2);
        }
}

// Lets boxes step between two leaves of the block side by side, the lower one given, where that is allowed.
void ExitGrower::relate(const glm::ivec3& lower, int axis) {
    glm::ivec3 upper = lower;
    ++upper[axis];
    const std::uint64_t a = signatures_[indexOf(lower)];
    const std::uint64_t b = signatures_[indexOf(upper)];
    if ((a & ~b) != 0 && (b & ~a) != 0) return;
    const ListReader listA(references_ + leafList(*block_.word(lower)));
    const ListReader listB(references_ + leafList(*block_.word(upper)));
    const auto open = [&](const glm::ivec3& from, int face) {
        const glm::ivec3 place = placeOf(from);
        FaceRows& row = faces_[static_cast<std::size_t>(place.z * rowsPerSlice() + place.y)];
        row[static_cast<std::size_t>(face)] &= ~(std::uint64_t(1) << place.x);
    };
    if ((a & ~b) == 0 && isSubset(listA, listB)) open(upper, 2 * axis);
    if ((b & ~a) == 0 && isSubset(listB, listA)) open(lower, 2 * axis + 1);
}

// The block is a part of the one that the object was made for.
void ExitGrower::growAll(const VoxelBlock& block) {
    const glm::ivec3 inner = block.first - block_.first;
    const std::uint64_t columns = (~std::uint64_t(0) >> (64 - block.size.x)) << inner.x;
    for (int z = inner.z; z < inner.z + block.size.z; ++z)
        for (int y = inner.y; y < inner.y + block.size.y; ++y) {
            std::uint64_t leaves = leafRows_[static_cast<std::size_t>(z * block_.size.y + y)] & columns;
            for (; leaves != 0; leaves &= leaves - 1) {
                const glm::ivec3 voxel(std::countr_zero(leaves), y, z);
                std::uint32_t& exitBox = references_[leafList(*block_.word(voxel))];
                exitBox = ExitBox(faces_.get(), rowsPerSlice(), placeOf(voxel)).grow(reach_);
            }
        }
}

} // namespace

void growExits(const OccupancyWindow& window, const VoxelBlock& block, const VoxelBlock& known,
               std::uint32_t* references, int reach) {
    if (reach > 0) ExitGrower(window, known, references, reach).growAll(block);
}

} // namespace rt
