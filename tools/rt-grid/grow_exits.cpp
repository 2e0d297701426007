#include "tools/rt-grid/grow_exits.h"

#include "formats/atlas.shared.h"

#include <bit>

namespace rt {
namespace {

// Calls visit() with the triangles of a list, ascending, until it returns false; returns whether it never
// did.
template <class Visit>
bool forAllOfList(const std::uint32_t* list, Visit&& visit) {
    const std::uint32_t* const end = list + kListHeaderWords + list[1];
    for (list += kListHeaderWords; list != end; ++list)
        if (!visit(*list)) return false;
    return true;
}

std::uint64_t bitOf(std::uint32_t triangle) {
    return std::uint64_t(1) << (triangle & 63);
}

} // namespace

void ExitGrower::grow(const glm::ivec3& voxel, std::uint32_t leaf) {
    std::uint32_t* const list = references_ + leafList(leaf);
    list_.clear();
    signature_ = 0;
    covered_ = leaf;
    forAllOfList(list, [&](std::uint32_t triangle) {
        list_.push_back(triangle);
        signature_ |= bitOf(triangle);
        return true;
    });
    corners_ = {voxel, voxel};
    unsigned growing = 63; // one bit for each face
    for (int i = 0; i < reach_ && growing != 0; ++i)
        for (int face = 0; face < 6; ++face)
            if ((growing >> face & 1) && !tryFace(face)) growing &= ~(1u << face);
    list[0] = freeBoxWord(voxel - corners_[0], corners_[1] - voxel);
}

// Moves the face by one voxel if the box may cover all voxels in front of it.
bool ExitGrower::tryFace(int face) {
    const int axis = face >> 1;
    const int up = face & 1;
    std::array<glm::ivec3, 2> slab = corners_;
    slab[0][axis] = slab[1][axis] = corners_[std::size_t(up)][axis] + 2 * up - 1;
    const auto& [lo, hi] = slab;
    const std::uint64_t columns = (~std::uint64_t(0) >> (63 - (hi.x - lo.x))) << lo.x;
    for (int z = lo.z; z <= hi.z; ++z)
        for (int y = lo.y; y <= hi.y; ++y)
            for (std::uint64_t bits = window_.row(y, z) & columns; bits != 0; bits &= bits - 1)
                if (!mayCover(window_.wordAt(occupancy_, {std::countr_zero(bits), y, z}))) return false;
    corners_[std::size_t(up)][axis] = lo[axis];
    return true;
}

bool ExitGrower::mayCover(std::uint32_t word) {
    if (word == covered_) return true;
    if (isBrick(word)) return false;
    found_ = 0;
    const bool subset =
        forAllOfList(references_ + leafList(word), [&](std::uint32_t triangle) { return holds(triangle); });
    if (subset) covered_ = word;
    return subset;
}

// Whether the leaf's list has the triangle. To be asked for a list's triangles in ascending order.
bool ExitGrower::holds(std::uint32_t triangle) {
    if (!(signature_ & bitOf(triangle))) return false;
    while (found_ < list_.size() && list_[found_] < triangle) ++found_;
    return found_ < list_.size() && list_[found_] == triangle;
}

} // namespace rt
