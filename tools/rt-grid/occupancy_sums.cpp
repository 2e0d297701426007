#include "tools/rt-grid/occupancy_sums.h"

#include <algorithm>

namespace rt {

void OccupancySums::count(const Atlas& atlas, const CellBox& region) {
    const glm::ivec3 gridEnd = glm::ivec3(atlas.grid.dims) << region.level;
    region_ = {glm::max(region.lo, glm::ivec3(0)), glm::min(region.hi, gridEnd - 1), region.level};
    stride_ = glm::uvec3(glm::max(region_.hi - region_.lo + 1, glm::ivec3(0)) + 1);
    sums_.assign(std::size_t(stride_.x) * stride_.y * stride_.z, 0);
    const CellBlock voxels{{}, region_.hi - region_.lo + 1, region_.lo, region_.level};
    const auto isOpen = [&](const CellPlace& brick) { // a voxel that is marked needs no second look
        const int coarser = brick.level - region_.level;
        return coarser < 0 || sums_[index((brick.at >> coarser) - region_.lo + 1)] == 0;
    };
    forEachLeafIn(atlas, gridBlock(atlas), region_, isOpen, [&](std::uint32_t, const CellPlace& leaf) {
        mark(partOf(voxels, {leaf.at, leaf.at, leaf.level}));
        return true;
    });
    for (std::uint32_t z = 1; z < stride_.z; ++z)
        for (std::uint32_t y = 1; y < stride_.y; ++y) {
            std::uint32_t* const here = &sums_[index({0, y, z})];
            const std::uint32_t* const before = here - stride_.x;
            const std::uint32_t* const below = here - std::size_t(stride_.x) * stride_.y;
            const std::uint32_t* const belowBefore = below - stride_.x;
            std::uint32_t row = 0;
            for (std::uint32_t x = 1; x < stride_.x; ++x) {
                row += here[x];
                here[x] = row + before[x] + below[x] - belowBefore[x];
            }
        }
}

void OccupancySums::mark(const CellBox& part) {
    forEachVoxel(part, [&](const glm::ivec3& at) {
        sums_[index(at - region_.lo + 1)] = 1;
        return true;
    });
}

std::uint32_t OccupancySums::in(const CellBox& box) const {
    const glm::ivec3 lo = glm::max(box.lo - region_.lo, glm::ivec3(0));
    const glm::ivec3 hi = glm::min(box.hi - region_.lo + 1, glm::ivec3(stride_) - 1);
    if (hi.x <= lo.x || hi.y <= lo.y || hi.z <= lo.z) return 0;
    const auto at = [&](int x, int y, int z) { return sums_[index({x, y, z})]; };
    return at(hi.x, hi.y, hi.z) - at(lo.x, hi.y, hi.z) - at(hi.x, lo.y, hi.z) - at(hi.x, hi.y, lo.z) +
           at(lo.x, lo.y, hi.z) + at(lo.x, hi.y, lo.z) + at(hi.x, lo.y, lo.z) - at(lo.x, lo.y, lo.z);
}

} // namespace rt
