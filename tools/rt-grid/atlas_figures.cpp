#include "tools/rt-grid/atlas_figures.h"

#include "tools/rt-grid/atlas_cells.h"

#include <cmath>

namespace rt {
namespace {

void addExtents(Histogram& extents, std::uint32_t box) {
    for (unsigned shift = 0; shift < 30; shift += 5) extents.add(box >> shift & 31u);
}

class FigureCount {
public:
    explicit FigureCount(const Atlas& atlas)
        : atlas_(atlas), structure_(atlas.grid.dims.w), ofTriangle_(atlas.triangles.size()) {}

    void add(const CellBlock& block) {
        LevelFigures& level = levelAt(block.level);
        for (const std::uint32_t word : block.words) {
            if (!(word & kOccupiedBit))
                addEmpty(level, word);
            else if (isBrick(word))
                ++level.crowded;
            else
                addLeaf(level, word);
        }
    }
    LevelFigures& levelAt(int level) {
        const auto index = static_cast<std::size_t>(level);
        if (index >= figures_.levels.size()) figures_.levels.resize(index + 1);
        return figures_.levels[index];
    }
    AtlasFigures finish() {
        for (const std::uint32_t references : ofTriangle_) figures_.referencesPerTriangle.add(references);
        double leaves = 0.0; // in voxels of the grid
        for (std::size_t level = 0; level < figures_.levels.size(); ++level)
            leaves +=
                std::ldexp(static_cast<double>(figures_.levels[level].leaves), -3 * static_cast<int>(level));
        figures_.occupiedVolume = leaves / static_cast<double>(atlas_.voxels.size());
        return std::move(figures_);
    }

private:
    void addEmpty(LevelFigures& level, std::uint32_t word) {
        ++level.empty;
        figures_.distances.add(static_cast<std::size_t>(leapDistance(structure_, word)));
        if (hasBoxes(structure_)) addExtents(figures_.extents, word);
    }
    void addLeaf(LevelFigures& level, std::uint32_t word) {
        ++level.leaves;
        const std::size_t list = leafList(word);
        if (hasBoxes(structure_)) addExtents(figures_.exits, atlas_.references[list]);
        std::size_t length = 0;
        for (std::uint32_t entry = 0; !(entry & kLastInList);) {
            entry = atlas_.references[list + kListHeaderWords + length++];
            ++ofTriangle_[entry & ~kLastInList];
        }
        figures_.referencesPerLeaf.add(length);
        level.references += length;
    }

    const Atlas& atlas_;
    std::uint32_t structure_;
    std::vector<std::uint32_t> ofTriangle_;
    AtlasFigures figures_;
};

} // namespace

void Histogram::add(std::size_t value, std::uint64_t times) {
    if (value >= counts_.size()) counts_.resize(value + 1);
    counts_[value] += times;
    count_ += times;
    sum_ += value * times;
}

AtlasFigures figuresOf(const Atlas& atlas) {
    FigureCount count(atlas);
    count.add(gridBlock(atlas));
    for (const BrickPlace& brick : bricksOf(atlas, "atlas")) {
        ++count.levelAt(brick.level).bricks[1 << brick.shift];
        count.add(brickBlock(atlas, brick));
    }
    return count.finish();
}

} // namespace rt
