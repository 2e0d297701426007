#include "tools/rt-grid/nest_bricks.h"

#include "tools/rt-grid/block_builder.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace rt {
namespace {

constexpr std::size_t kFewestVoxels = 64; // of a block
constexpr std::size_t kMostBlocks = 1u << 16;

// Blocks of large grids have more voxels: what is kept for each would take a third of the grid's memory.
std::size_t voxelsPerBlock(std::size_t voxels) {
    return std::max(kFewestVoxels, (voxels + kMostBlocks - 1) / kMostBlocks);
}

struct BlockStart {
    std::size_t brick = 0;
    std::size_t reference = 0;
    std::size_t place = 0;
};

std::uint32_t relocated(std::uint32_t word, const BlockStart& start) {
    if (isBrick(word)) return word + static_cast<std::uint32_t>(start.brick >> 3);
    return word & kOccupiedBit ? word + static_cast<std::uint32_t>(start.reference) : word;
}

// Moves the blocks, one after the other, into the whole.
class Assembly {
public:
    Assembly(const std::vector<Block>& blocks, NestedVoxels& whole) : blocks_(blocks), whole_(whole) {
        starts_.reserve(blocks.size());
        BlockStart next;
        for (const Block& block : blocks) {
            starts_.push_back(next);
            next.brick += block.bricks.size();
            next.reference += block.references.size();
            next.place += block.places.size();
            whole.occupiedVoxels += block.leaves;
        }
        whole.bricks = FreshArray<std::uint32_t>(next.brick);
        whole.references = FreshArray<std::uint32_t>(next.reference);
        whole.referenceCount = next.reference - kListHeaderWords * whole.occupiedVoxels;
        whole.places.resize(next.place);
    }
    void move(std::size_t i) {
        const Block& block = blocks_[i];
        const BlockStart& start = starts_[i];
        const std::size_t perBlock = voxelsPerBlock(whole_.voxels.size());
        const std::size_t firstVoxel = i * perBlock;
        const std::size_t lastVoxel = std::min(whole_.voxels.size(), firstVoxel + perBlock);
        const auto moved = [&](std::uint32_t word) { return relocated(word, start); };
        std::uint32_t* const voxels = whole_.voxels.data();
        std::transform(voxels + firstVoxel, voxels + lastVoxel, voxels + firstVoxel, moved);
        std::transform(block.bricks.begin(), block.bricks.end(), whole_.bricks.data() + start.brick, moved);
        std::copy(block.references.begin(), block.references.end(),
                  whole_.references.data() + start.reference);
        for (std::size_t k = 0; k < block.places.size(); ++k) {
            BrickPlace& place = whole_.places[start.place + k] = block.places[k];
            place.offset += static_cast<std::uint32_t>(start.brick);
        }
    }

private:
    const std::vector<Block>& blocks_;
    NestedVoxels& whole_;
    std::vector<BlockStart> starts_;
};

} // namespace

NestedVoxels nestBricks(CellRefs grid, std::span<const TriangleRecord> triangles, const GridLayout& layout,
                        const NestOptions& options, const ReferenceLimit& limit, WorkMeter& meter) {
    NestedVoxels nested;
    nested.voxels = std::move(grid.voxels);
    const std::size_t perBlock = voxelsPerBlock(nested.voxels.size());
    std::vector<Block> blocks((nested.voxels.size() + perBlock - 1) / perBlock);
    WordBudget budget(grid.referenceCount, limit);
    meter.begin(blocks.size());
    const Nesting nesting = nestingOf(triangles, layout, options, budget);
    tbb::enumerable_thread_specific<BlockBuilder> builders([&] { return BlockBuilder(nesting); });
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) {
        const std::size_t first = i * perBlock;
        const std::span<std::uint32_t> voxels = std::span(nested.voxels).subspan(first);
        blocks[i] = builders.local().build(grid, voxels.first(std::min(voxels.size(), perBlock)), first);
        meter.add();
    });
    Assembly assembly(blocks, nested);
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) { assembly.move(i); });
    return nested;
}

} // namespace rt
