#include "tools/rt-grid/nest_bricks.h"

#include "common/error.h"
#include "tools/rt-grid/brick_cost.h"
#include "tools/rt-grid/leaf_relations.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <sys/mman.h>
#include <utility>

namespace rt {
namespace {

constexpr std::size_t kVoxelsPerBlock = 64;
constexpr std::size_t kHugePage = std::size_t(1) << 21; // bytes
constexpr std::size_t kAhead = 8;                       // triangles asked from memory before their turn
constexpr double kLargestSpread =
    2.0; // voxels that a triangle meets on average where a brick parts triangles

// What consecutive voxels of the grid hold; offsets count from the block's own beginning.
struct Block {
    std::vector<std::uint32_t> bricks;
    std::vector<std::uint32_t> references;
    std::vector<BrickPlace> places;
    std::uint64_t leaves = 0;
};

// Counts words over all blocks and stops the build where they become too many.
class WordBudget {
public:
    WordBudget(std::uint64_t used, const ReferenceLimit& limit) : used_(used), limit_(limit) {}
    void take(std::uint64_t words) {
        if (used_.fetch_add(words, std::memory_order_relaxed) + words > limit_.references)
            throw Error(ErrorKind::LimitExceeded, limit_.message);
    }

private:
    std::atomic<std::uint64_t> used_;
    const ReferenceLimit& limit_;
};

struct Nesting {
    std::span<const TriangleRecord> triangles;
    const GridLayout& layout;
    const NestOptions& options;
    BrickCost cost;
    WordBudget& budget;
};

// Reports words to the budget now and then: threads would wait for one another at every list.
class WordCount {
public:
    explicit WordCount(WordBudget& budget) : budget_(budget) {}
    void take(std::uint64_t words) {
        words_ += words;
        if (words_ >= kWordsPerReport) report();
    }
    void report() { budget_.take(std::exchange(words_, 0)); }

private:
    static constexpr std::uint64_t kWordsPerReport = 4096;
    WordBudget& budget_;
    std::uint64_t words_ = 0;
};

// A triangle in a voxel of a brick.
struct Entry {
    std::uint32_t cell;
    std::uint32_t triangle;
};

// Makes entries of the brick's triangles and counts them in its voxels' words.
RT_WIDE_LANES void binInto(const BrickPlace& place, const Nesting& nesting,
                           std::span<const std::uint32_t> list, std::uint32_t* counts,
                           std::vector<Entry>& entries, LeafRelations& relations) {
    const double pad = padCellsFor(nesting.layout.dims, place.level);
    const VoxelSpace space(nesting.layout, place.level, place.first);
    const glm::uvec3 dims(1u << place.shift);
    entries.clear();
    relations.begin(place.words(), list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (i + kAhead < list.size()) __builtin_prefetch(&nesting.triangles[list[i + kAhead]]);
        const std::uint32_t id = list[i];
        forEachVoxelOf(space.of(nesting.triangles[id]), dims, pad, [&](std::uint32_t cell) {
            ++counts[cell];
            entries.push_back({cell, id});
            relations.add(cell, i);
        });
    }
}

class BlockBuilder {
public:
    BlockBuilder(const Nesting& nesting, Block& block)
        : nesting_(nesting), block_(block), words_(nesting.budget) {}
    // To be called after the last voxel.
    void finish() { words_.report(); }

    // Returns the word of a voxel of the grid with the list at offset `list`.
    std::uint32_t wordOf(const glm::uvec3& voxel, const CellRefs& grid, std::size_t list) {
        copyTriangles(grid.references, list, lists_);
        words_.take(lists_.size());
        const bool isShort = lists_.size() <= nesting_.options.gridLeafSize || nesting_.options.maxDepth == 0;
        const int shift = isShort ? 0 : nesting_.cost.shiftFor(lists_, 0);
        if (shift == 0) return leafWord(copyLeaf(lists_));
        pending_.clear();
        const std::uint32_t word = newBrick(glm::ivec3(voxel), shift, 0, 0);
        pending_.push_back({block_.places.size() - 1, 0, lists_.size()});
        for (std::size_t i = 0; i < pending_.size(); ++i) fillBrick(pending_[i]);
        return word;
    }

private:
    struct Pending {
        std::size_t place;
        std::size_t firstInList; // in lists_
        std::size_t count;
    };
    // A brick's voxel while its list is filled.
    static constexpr std::uint32_t kToBrick = 0x80000000u; // the list goes to lists_, not to references

    // A leaf whose entries are still 0, but for the mark of the last one.
    std::uint32_t newLeaf(std::size_t count) {
        words_.take(kListHeaderWords);
        const std::size_t offset = block_.references.size();
        block_.references.resize(offset + kListHeaderWords + count);
        block_.references.back() = kLastInList;
        ++block_.leaves;
        return static_cast<std::uint32_t>(offset);
    }
    std::uint32_t copyLeaf(std::span<const std::uint32_t> list) {
        const std::uint32_t offset = newLeaf(list.size());
        std::copy(list.begin(), list.end(), block_.references.begin() + offset + kListHeaderWords);
        block_.references.back() |= kLastInList;
        return offset;
    }
    std::uint32_t newBrick(const glm::ivec3& voxel, int shift, int level, int depth) {
        const auto offset = static_cast<std::uint32_t>(block_.bricks.size());
        const BrickPlace place{offset, shift, level + shift, depth + 1, voxel * (1 << shift)};
        words_.take(place.words());
        block_.bricks.resize(offset + std::size_t(place.words()));
        block_.places.push_back(place);
        return brickWord(offset, shift);
    }

    void fillBrick(const Pending pending) {
        const BrickPlace place = block_.places[pending.place];
        binInto(place, nesting_, std::span(lists_).subspan(pending.firstInList, pending.count),
                block_.bricks.data() + place.offset, entries_, relations_);
        words_.take(entries_.size());
        const bool deepest = place.depth >= nesting_.options.maxDepth;
        crowded_.clear();
        leaves_.clear();
        ends_.resize(place.words());
        std::size_t end = lists_.size();
        for (std::uint32_t cell = 0; cell < place.words(); ++cell) {
            const std::uint32_t count = block_.bricks[place.offset + cell];
            if (count == 0) continue;
            if (count <= nesting_.options.leafSize || deepest) {
                const std::uint32_t offset = newLeaf(count);
                ends_[cell] = offset + kListHeaderWords;
                block_.bricks[place.offset + cell] = leafWord(offset);
                leaves_.push_back(cell);
                continue;
            }
            crowded_.push_back({cell, end, count});
            ends_[cell] = kToBrick | static_cast<std::uint32_t>(end);
            end += count;
        }
        lists_.resize(end);
        for (const Entry& entry : entries_) {
            const std::uint32_t e = ends_[entry.cell]++;
            (e & kToBrick ? lists_[e & ~kToBrick] : block_.references[e]) |= entry.triangle;
        }
        for (const Crowded& voxel : crowded_) placeCrowded(place, voxel, pending.count);
        if (nesting_.options.exitReach > 0)
            relations_.nameSteps(std::span(block_.bricks).subspan(place.offset, place.words()), place.shift,
                                 leaves_, block_.references.data());
    }

    // A voxel that may become a brick.
    struct Crowded {
        std::uint32_t cell;
        std::size_t firstInList;
        std::size_t count;
    };
    void placeCrowded(const BrickPlace& parent, const Crowded& voxel, std::size_t parentCount) {
        const auto list = std::span(lists_).subspan(voxel.firstInList, voxel.count);
        const bool parted =
            voxel.count < parentCount ||
            static_cast<double>(entries_.size()) <= kLargestSpread * static_cast<double>(parentCount);
        const int shift = parted ? nesting_.cost.shiftFor(list, parent.level) : 0;
        if (shift == 0) {
            block_.bricks[parent.offset + voxel.cell] = leafWord(copyLeaf(list));
            leaves_.push_back(voxel.cell);
            return;
        }
        const std::uint32_t side = 1u << parent.shift;
        const glm::uvec3 at(voxel.cell & (side - 1), (voxel.cell >> parent.shift) & (side - 1),
                            voxel.cell >> (2 * parent.shift));
        const std::uint32_t word = newBrick(parent.first + glm::ivec3(at), shift, parent.level, parent.depth);
        block_.bricks[parent.offset + voxel.cell] = word;
        pending_.push_back({block_.places.size() - 1, voxel.firstInList, voxel.count});
    }

    const Nesting& nesting_;
    Block& block_;
    WordCount words_;
    std::vector<Pending> pending_;     // bricks of this voxel of the grid, in the order of bricksOf()
    std::vector<std::uint32_t> lists_; // the triangles of those bricks
    std::vector<Entry> entries_;       // of the brick that is being filled
    std::vector<std::uint32_t> ends_;
    std::vector<Crowded> crowded_;
    std::vector<std::uint32_t> leaves_; // that brick's
    LeafRelations relations_;
};

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
    Assembly(std::vector<Block>& blocks, NestedVoxels& whole) : blocks_(blocks), whole_(whole) {
        starts_.reserve(blocks.size());
        BlockStart next;
        for (const Block& block : blocks) {
            starts_.push_back(next);
            next.brick += block.bricks.size();
            next.reference += block.references.size();
            next.place += block.places.size();
            whole.occupiedVoxels += block.leaves;
        }
        whole.bricks = WordArray(next.brick);
        whole.references = WordArray(next.reference);
        whole.referenceCount = next.reference - kListHeaderWords * whole.occupiedVoxels;
        whole.places.resize(next.place);
    }
    void move(std::size_t i) {
        Block& block = blocks_[i];
        const BlockStart& start = starts_[i];
        const std::size_t firstVoxel = i * kVoxelsPerBlock;
        const std::size_t lastVoxel = std::min(whole_.voxels.size(), firstVoxel + kVoxelsPerBlock);
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
        block = Block();
    }

private:
    std::vector<Block>& blocks_;
    NestedVoxels& whole_;
    std::vector<BlockStart> starts_;
};

} // namespace

WordArray::WordArray(std::size_t count) : size(count) {
    if (count == 0) return;
    const std::size_t bytes = (count * sizeof(std::uint32_t) + kHugePage - 1) / kHugePage * kHugePage;
    void* const memory = std::aligned_alloc(kHugePage, bytes);
    if (!memory) throw std::bad_alloc();
    madvise(memory, bytes, MADV_HUGEPAGE); // only a wish: less time in page faults
    words = std::shared_ptr<std::uint32_t[]>(static_cast<std::uint32_t*>(memory), std::free);
}

NestedVoxels nestBricks(CellRefs grid, std::span<const TriangleRecord> triangles, const GridLayout& layout,
                        const NestOptions& options, const ReferenceLimit& limit) {
    NestedVoxels nested;
    nested.voxels = std::move(grid.voxels);
    std::vector<Block> blocks((nested.voxels.size() + kVoxelsPerBlock - 1) / kVoxelsPerBlock);
    WordBudget budget(grid.referenceCount, limit);
    const glm::uvec3 dims = layout.dims;
    const Nesting nesting{triangles, layout, options,
                          BrickCost(triangles, layout.cellsPerUnit, options.wordCost,
                                    finestLevelOf(std::max({dims.x, dims.y, dims.z}))),
                          budget};
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) {
        BlockBuilder builder(nesting, blocks[i]);
        const std::size_t last = std::min(nested.voxels.size(), (i + 1) * kVoxelsPerBlock);
        for (std::size_t voxel = i * kVoxelsPerBlock; voxel < last; ++voxel) {
            std::uint32_t& word = nested.voxels[voxel];
            if (word == 0) continue;
            const std::size_t row = voxel / dims.x;
            const glm::uvec3 at(voxel % dims.x, row % dims.y, row / dims.y);
            word = builder.wordOf(at, grid, leafList(word));
        }
        builder.finish();
    });
    Assembly assembly(blocks, nested);
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) { assembly.move(i); });
    return nested;
}

} // namespace rt
