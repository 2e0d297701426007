#include "tools/rt-grid/forecast_bricks.h"

#include "tools/rt-grid/block_builder.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rt {
namespace {

constexpr double kSampledVoxels = 4096.0; // by which a forecast is made, about

// A voxel of the grid, and how many like it there are.
struct SampledVoxel {
    std::size_t index;
    double weight;
};

std::size_t listLength(const CellRefs& grid, std::uint32_t word) {
    const std::uint32_t* entry = &grid.references[leafList(word) + kListHeaderWords];
    std::size_t length = 1;
    for (; !(*entry & kLastInList); ++entry) ++length;
    return length;
}

std::vector<SampledVoxel> sampleVoxels(const CellRefs& grid) {
    const double step = std::max(1.0, static_cast<double>(grid.referenceCount) / kSampledVoxels);
    std::vector<SampledVoxel> sample;
    double sum = 0.5 * step; // of the lists so far that are shorter than a step
    for (std::size_t i = 0; i < grid.voxels.size(); ++i) {
        if (grid.voxels[i] == 0) continue;
        const auto length = static_cast<double>(listLength(grid, grid.voxels[i]));
        if (length >= step) {
            sample.push_back({i, 1.0});
        } else if ((sum += length) >= step) {
            sum -= step;
            sample.push_back({i, step / length});
        }
    }
    return sample;
}

// Adds what one voxel becomes.
void addSample(const CellRefs& grid, const SampledVoxel& voxel, BlockBuilder& builder, NestedSize& size) {
    std::uint32_t word = grid.voxels[voxel.index];
    const std::uint64_t wordsBefore = builder.wordsTaken();
    const Block block = builder.build(grid, std::span(&word, 1), voxel.index);
    size.bricks += voxel.weight * static_cast<double>(block.places.size());
    size.brickWords += voxel.weight * static_cast<double>(block.bricks.size());
    size.leaves += voxel.weight * static_cast<double>(block.leaves);
    size.referenceWords += voxel.weight * static_cast<double>(block.references.size());
    size.budgetWords += voxel.weight * static_cast<double>(builder.wordsTaken() - wordsBefore);
}

} // namespace

NestedSize forecastBricks(const CellRefs& grid, std::span<const TriangleRecord> triangles,
                          const GridLayout& layout, const NestOptions& options) {
    constexpr std::size_t kPerBlock = 32; // voxels of the sample that a thread takes at a time
    const ReferenceLimit noLimit{~std::uint64_t(0), {}};
    WordBudget budget(0, noLimit);
    const Nesting nesting = nestingOf(triangles, layout, options, budget);
    const std::vector<SampledVoxel> sample = sampleVoxels(grid);
    std::vector<NestedSize> blocks((sample.size() + kPerBlock - 1) / kPerBlock);
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) {
        const std::size_t last = std::min(sample.size(), (i + 1) * kPerBlock);
        BlockBuilder builder(nesting);
        for (std::size_t k = i * kPerBlock; k < last; ++k) addSample(grid, sample[k], builder, blocks[i]);
    });
    NestedSize size;
    for (const NestedSize& block : blocks) {
        size.bricks += block.bricks;
        size.brickWords += block.brickWords;
        size.leaves += block.leaves;
        size.referenceWords += block.referenceWords;
        size.budgetWords += block.budgetWords;
    }
    return size;
}

} // namespace rt
