#pragma once
#include "formats/atlas.h"
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/brick_cost.h"
#include "tools/rt-grid/nest_options.h"

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace rt {

/// Counts words over all blocks and stops the build where they become too many. The limit has to outlive it.
class WordBudget {
public:
    WordBudget(std::uint64_t used, const ReferenceLimit& limit) : used_(used), limit_(limit) {}
    /// Throws Error{LimitExceeded} with the limit's message.
    void take(std::uint64_t words);

private:
    std::atomic<std::uint64_t> used_;
    const ReferenceLimit& limit_;
};

/// What all blocks are built of; all of it has to outlive the builders.
struct Nesting {
    std::span<const TriangleRecord> triangles;
    const GridLayout& layout;
    const NestOptions& options;
    BrickCost cost;
    WordBudget& budget;
};
/// With the cost model that the options ask for.
Nesting nestingOf(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                  const NestOptions& options, WordBudget& budget);

/// What consecutive voxels of the grid hold; offsets count from the block's own beginning.
struct Block {
    std::span<const std::uint32_t> bricks;
    std::span<const std::uint32_t> references;
    std::vector<BrickPlace> places;
    std::uint64_t leaves = 0;
};

/// Builds blocks one after the other, in the same memory.
class BlockBuilder {
public:
    explicit BlockBuilder(const Nesting& nesting);
    ~BlockBuilder();
    /// Replaces the words of voxels of the grid, from `first` on. The block lives as long as the object.
    Block build(const CellRefs& grid, std::span<std::uint32_t> voxels, std::size_t first);
    /// Words of all blocks that count against the budget.
    std::uint64_t wordsTaken() const;

private:
    class State;
    std::unique_ptr<State> state_;
};

} // namespace rt
