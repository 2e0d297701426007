#include "tools/rt-grid/atlas_cells.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {

CellBlock gridBlock(const Atlas& atlas) {
    return {atlas.voxels, glm::ivec3(atlas.grid.dims), glm::ivec3(0), 0};
}

CellBlock brickBlock(const Atlas& atlas, std::uint32_t word, const CellPlace& place) {
    const int shift = brickShift(word);
    const glm::ivec3 side(1 << shift);
    return {atlas.bricks.subspan(brickOffset(word), std::size_t(1) << (3 * shift)), side, place.at * side,
            place.level + shift};
}

CellBlock brickBlock(const Atlas& atlas, const BrickPlace& place) {
    return {atlas.bricks.subspan(place.offset, place.words()), glm::ivec3(1 << place.shift), place.first,
            place.level};
}

CellBox partOf(const CellBlock& block, const CellBox& box) {
    const glm::ivec3 last = block.first + block.dims - 1;
    CellBox part{block.first, last, block.level};
    const int finer = block.level - box.level;
    for (int axis = 0; axis < 3; ++axis) { // 64 bits: a box may reach far beyond the grid
        const auto lo = std::int64_t(box.lo[axis]), hi = std::int64_t(box.hi[axis]);
        const std::int64_t least = finer >= 0 ? lo * (std::int64_t(1) << finer) : lo >> -finer;
        const std::int64_t most = finer >= 0 ? (hi + 1) * (std::int64_t(1) << finer) - 1 : hi >> -finer;
        part.lo[axis] = static_cast<int>(std::clamp<std::int64_t>(least, part.lo[axis], last[axis] + 1));
        part.hi[axis] = static_cast<int>(std::clamp<std::int64_t>(most, part.lo[axis] - 1, last[axis]));
    }
    return part;
}

CellBox leapBoxOf(std::uint32_t structure, std::uint32_t word, const CellPlace& place) {
    if (hasBoxes(structure)) return freeBoxOf(word, place);
    const int radius = structure == kStructureCloud ? static_cast<int>(word) - 1 : 0;
    return {place.at - radius, place.at + radius, place.level};
}

int leapDistance(std::uint32_t structure, std::uint32_t word) {
    if (structure == kStructureUniform) return 1;
    if (structure == kStructureCloud) return static_cast<int>(word);
    const glm::ivec3 least = glm::min(freeBelow(word), freeAbove(word));
    return 1 + std::min({least.x, least.y, least.z});
}

std::string nameOf(const CellPlace& place) {
    return fmt::format("voxel ({}, {}, {}) of level {}", place.at.x, place.at.y, place.at.z, place.level);
}

} // namespace rt
