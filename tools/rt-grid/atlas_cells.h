#pragma once
#include "formats/atlas.h"

#include <span>
#include <string>

namespace rt {

/// A voxel: its side is 2^-level of a grid voxel's, and `at` counts such voxels from the grid's corner.
struct CellPlace {
    glm::ivec3 at{0};
    int level = 0;
};

/// Voxels of one level from `lo` to `hi`, both included.
struct CellBox {
    glm::ivec3 lo{0};
    glm::ivec3 hi{0};
    int level = 0;

    bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
};

/// The words of the grid or of a brick, x fastest.
struct CellBlock {
    std::span<const std::uint32_t> words;
    glm::ivec3 dims{1};
    glm::ivec3 first{0}; ///< its first voxel, in voxels of its level
    int level = 0;

    std::uint32_t word(const glm::ivec3& at) const {
        const glm::ivec3 v = at - first;
        return words[(static_cast<std::size_t>(v.z) * static_cast<std::size_t>(dims.y) +
                      static_cast<std::size_t>(v.y)) *
                         static_cast<std::size_t>(dims.x) +
                     static_cast<std::size_t>(v.x)];
    }
    CellPlace place(std::size_t index) const {
        const auto width = static_cast<std::size_t>(dims.x);
        const auto row = index / width;
        const auto height = static_cast<std::size_t>(dims.y);
        return {first + glm::ivec3(glm::uvec3(index % width, row % height, row / height)), level};
    }
};

CellBlock gridBlock(const Atlas& atlas);
/// The brick that `word`, of a voxel at `place`, holds.
CellBlock brickBlock(const Atlas& atlas, std::uint32_t word, const CellPlace& place);
CellBlock brickBlock(const Atlas& atlas, const BrickPlace& place);

/// The voxels of `block` that lie in `box`, whole or in part.
CellBox partOf(const CellBlock& block, const CellBox& box);

/// What a box word says of the voxel at `place`: which voxels of its size rays may leap over, its own
/// included.
inline CellBox freeBoxOf(std::uint32_t word, const CellPlace& place) {
    return {place.at - freeBelow(word), place.at + freeAbove(word), place.level};
}

/// What an empty voxel's word, or a leaf's exit box where there are such, lets rays leap over in a structure.
CellBox leapBoxOf(std::uint32_t structure, std::uint32_t word, const CellPlace& place);

/// How many voxels rays of any direction may leap at least from an empty voxel, itself included: the
/// chessboard distance to the nearest side of what they may leap over.
int leapDistance(std::uint32_t structure, std::uint32_t word);

/// "voxel (3, 4, 5) of level 2".
std::string nameOf(const CellPlace& place);

/// Calls visit(x, y, z) for all voxels of a box, x fastest, as long as it returns true. Returns whether it
/// always did.
template <class Visit>
bool forEachVoxel(const CellBox& box, Visit&& visit) {
    for (int z = box.lo.z; z <= box.hi.z; ++z)
        for (int y = box.lo.y; y <= box.hi.y; ++y)
            for (int x = box.lo.x; x <= box.hi.x; ++x)
                if (!visit(glm::ivec3(x, y, z))) return false;
    return true;
}

/// Calls visit(word, place) for every leaf that lies in `box`, whole or in part, as long as it returns true,
/// and enter(place) before it looks into a brick, which it leaves out where that returns false. Returns
/// whether visit always returned true.
template <class Enter, class Visit>
bool forEachLeafIn(const Atlas& atlas, const CellBlock& block, const CellBox& box, Enter&& enter,
                   Visit&& visit) {
    return forEachVoxel(partOf(block, box), [&](const glm::ivec3& at) {
        const std::uint32_t word = block.word(at);
        if (!(word & kOccupiedBit)) return true;
        const CellPlace place{at, block.level};
        if (!isBrick(word)) return visit(word, place);
        return !enter(place) || forEachLeafIn(atlas, brickBlock(atlas, word, place), box, enter, visit);
    });
}
template <class Visit>
bool forEachLeafIn(const Atlas& atlas, const CellBox& box, Visit&& visit) {
    return forEachLeafIn(
        atlas, gridBlock(atlas), box, [](const CellPlace&) { return true; }, visit);
}

} // namespace rt
