#include "tools/rt-grid/nest_bricks.h"

#include "common/error.h"
#include "tools/rt-grid/brick_cost.h"
#include "tools/rt-grid/leaf_relations.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

namespace rt {
namespace {

constexpr std::size_t kFewestVoxels = 64; // of a block
constexpr std::size_t kMostBlocks = 1u << 16;
constexpr std::size_t kBatch =
    16; // triangles that are asked from memory, and whose boxes are found, together
constexpr double kSampledVoxels = 4096.0; // by which a forecast is made, about
constexpr double kLargestSpread =
    2.0; // voxels that a triangle meets on average where a brick parts triangles

// Blocks of large grids have more voxels: what is kept for each would take a third of the grid's memory.
std::size_t voxelsPerBlock(std::size_t voxels) {
    return std::max(kFewestVoxels, (voxels + kMostBlocks - 1) / kMostBlocks);
}

// What consecutive voxels of the grid hold; offsets count from the block's own beginning.
struct Block {
    std::span<const std::uint32_t> bricks;
    std::span<const std::uint32_t> references;
    std::vector<BrickPlace> places;
    std::uint64_t leaves = 0;
};

// Keeps copies of words, many of them in one piece of memory.
class WordStore {
public:
    std::span<const std::uint32_t> keep(std::span<const std::uint32_t> words) {
        if (words.size() > free_.size()) {
            pieces_.emplace_back(std::max(words.size(), kWordsPerPiece));
            free_ = pieces_.back();
        }
        const std::span<std::uint32_t> kept = free_.first(words.size());
        free_ = free_.subspan(words.size());
        std::copy(words.begin(), words.end(), kept.begin());
        return kept;
    }

private:
    static constexpr std::size_t kWordsPerPiece = std::size_t(1) << 20;
    std::vector<FreshArray<std::uint32_t>> pieces_;
    std::span<std::uint32_t> free_; // of the last piece
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
    void report() {
        taken_ += words_;
        budget_.take(std::exchange(words_, 0));
    }
    /// All that was reported.
    std::uint64_t taken() const { return taken_; }

private:
    static constexpr std::uint64_t kWordsPerReport = 4096;
    WordBudget& budget_;
    std::uint64_t words_ = 0, taken_ = 0;
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
    const double pad = nesting.layout.padScale * padCellsFor(nesting.layout.dims, place.level);
    const VoxelSpace space(nesting.layout, place.level, place.first);
    const glm::uvec3 dims(1u << place.shift);
    entries.clear();
    relations.begin(place.words(), list.size());
    std::array<VoxelTriangle, kBatch> corners;
    std::array<voxelize::Box, kBatch> boxes;
    for (std::size_t first = 0; first < list.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, list.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            if (first + i + kBatch < list.size())
                __builtin_prefetch(&nesting.triangles[list[first + i + kBatch]]);
            corners[i] = space.of(nesting.triangles[list[first + i]]);
            boxes[i] = voxelize::Box(corners[i], dims, pad);
        }
        for (std::size_t i = 0; i < count; ++i)
            forEachVoxelOf(corners[i], boxes[i], dims, pad, [&](std::uint32_t cell) {
                ++counts[cell];
                entries.push_back({cell, list[first + i]});
                relations.add(cell, first + i);
            });
    }
}

// Builds blocks one after the other, in the same memory.
class BlockBuilder {
public:
    explicit BlockBuilder(const Nesting& nesting) : nesting_(nesting), words_(nesting.budget) {}

    // Replaces the words of voxels of the grid, from `first` on. The block lives as long as the object.
    Block build(const CellRefs& grid, std::span<std::uint32_t> voxels, std::size_t first) {
        bricks_.clear();
        references_.clear();
        places_.clear();
        leaves_ = 0;
        const glm::uvec3& dims = nesting_.layout.dims;
        for (std::size_t i = first; std::uint32_t & word : voxels) {
            const std::size_t row = i / dims.x;
            if (word != 0)
                word = wordOf(glm::uvec3(i % dims.x, row % dims.y, row / dims.y), grid, leafList(word));
            ++i;
        }
        words_.report();
        return {store_.keep(bricks_), store_.keep(references_), places_, leaves_};
    }

    /// Words of all blocks that count against the budget.
    std::uint64_t wordsTaken() const { return words_.taken(); }

private:
    // Returns the word of a voxel of the grid with the list at offset `list`.
    std::uint32_t wordOf(const glm::uvec3& voxel, const CellRefs& grid, std::size_t list) {
        copyTriangles(grid.references, list, lists_);
        words_.take(lists_.size());
        const bool isShort = lists_.size() <= nesting_.options.gridLeafSize || nesting_.options.maxDepth == 0;
        const int shift = isShort ? 0 : nesting_.cost.shiftFor(lists_, 0);
        if (shift == 0) return leafWord(copyLeaf(lists_));
        pending_.clear();
        const std::uint32_t word = newBrick(glm::ivec3(voxel), shift, 0, 0);
        pending_.push_back({places_.size() - 1, 0, lists_.size()});
        for (std::size_t i = 0; i < pending_.size(); ++i) fillBrick(pending_[i]);
        return word;
    }

    struct Pending {
        std::size_t place;
        std::size_t firstInList; // in lists_
        std::size_t count;
    };
    // A brick's voxel while its list is filled.
    static constexpr std::uint32_t kToBrick = 0x80000000u; // the list goes to lists_, not to references

    // A leaf with these triangles; returns where its list is.
    std::uint32_t copyLeaf(std::span<const std::uint32_t> list) {
        words_.take(kListHeaderWords);
        ++leaves_;
        const std::size_t offset = references_.size();
        references_.push_back(0);
        references_.insert(references_.end(), list.begin(), list.end());
        references_.back() |= kLastInList;
        return static_cast<std::uint32_t>(offset);
    }
    std::uint32_t newBrick(const glm::ivec3& voxel, int shift, int level, int depth) {
        const auto offset = static_cast<std::uint32_t>(bricks_.size());
        const BrickPlace place{offset, shift, level + shift, depth + 1, voxel * (1 << shift)};
        words_.take(place.words());
        bricks_.resize(offset + std::size_t(place.words()));
        places_.push_back(place);
        return brickWord(offset, shift);
    }

    void fillBrick(const Pending pending) {
        const BrickPlace place = places_[pending.place];
        binInto(place, nesting_, std::span(lists_).subspan(pending.firstInList, pending.count),
                bricks_.data() + place.offset, entries_, relations_);
        words_.take(entries_.size());
        placeLists(place);
        for (const Entry& entry : entries_) {
            const std::uint32_t end = ends_[entry.cell]++;
            (end & kToBrick ? lists_[end & ~kToBrick] : references_[end]) = entry.triangle;
        }
        for (const std::uint32_t cell : leafCells_) references_[ends_[cell] - 1] |= kLastInList;
        for (const Crowded& voxel : crowded_) placeCrowded(place, voxel, pending.count);
        if (nesting_.options.exitReach > 0)
            relations_.nameSteps(std::span(bricks_).subspan(place.offset, place.words()), place.shift,
                                 leafCells_, references_.data());
    }

    // Makes room for the lists of a brick's voxels, whose words are the numbers of their triangles.
    void placeLists(const BrickPlace& place) {
        crowded_.clear();
        leafCells_.clear();
        ends_.resize(std::max<std::size_t>(ends_.size(), place.words()));
        const std::uint32_t most =
            place.depth >= nesting_.options.maxDepth ? ~0u : nesting_.options.leafSize; // in a leaf
        std::size_t reference = references_.size();
        std::size_t end = lists_.size();
        for (std::uint32_t cell = 0; cell < place.words(); ++cell) {
            std::uint32_t& word = bricks_[place.offset + cell];
            const std::uint32_t count = word;
            if (count == 0) continue;
            if (count <= most) {
                word = leafWord(static_cast<std::uint32_t>(reference));
                ends_[cell] = static_cast<std::uint32_t>(reference) + kListHeaderWords;
                reference += kListHeaderWords + count;
                leafCells_.push_back(cell);
            } else {
                crowded_.push_back({cell, end, count});
                ends_[cell] = kToBrick | static_cast<std::uint32_t>(end);
                end += count;
            }
        }
        words_.take(kListHeaderWords * leafCells_.size());
        leaves_ += leafCells_.size();
        references_.resize(reference);
        lists_.resize(end);
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
            bricks_[parent.offset + voxel.cell] = leafWord(copyLeaf(list));
            leafCells_.push_back(voxel.cell);
            return;
        }
        const std::uint32_t side = 1u << parent.shift;
        const glm::uvec3 at(voxel.cell & (side - 1), (voxel.cell >> parent.shift) & (side - 1),
                            voxel.cell >> (2 * parent.shift));
        const std::uint32_t word = newBrick(parent.first + glm::ivec3(at), shift, parent.level, parent.depth);
        bricks_[parent.offset + voxel.cell] = word;
        pending_.push_back({places_.size() - 1, voxel.firstInList, voxel.count});
    }

    const Nesting& nesting_;
    WordCount words_;
    WordStore store_;
    std::vector<std::uint32_t> bricks_, references_; // of the block
    std::vector<BrickPlace> places_;
    std::uint64_t leaves_ = 0;
    std::vector<Pending> pending_;     // bricks of this voxel of the grid, in the order of bricksOf()
    std::vector<std::uint32_t> lists_; // the triangles of those bricks
    std::vector<Entry> entries_;       // of the brick that is being filled
    std::vector<std::uint32_t> ends_;
    std::vector<Crowded> crowded_;
    std::vector<std::uint32_t> leafCells_; // that brick's
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

Nesting nestingOf(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                  const NestOptions& options, WordBudget& budget) {
    const glm::uvec3& dims = layout.dims;
    return {triangles, layout, options,
            BrickCost(triangles, layout.cellsPerUnit, options.wordCost,
                      finestLevelOf(std::max({dims.x, dims.y, dims.z}))),
            budget};
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

NestedSize forecastBricks(const CellRefs& grid, std::span<const TriangleRecord> triangles,
                          const GridLayout& layout, const NestOptions& options) {
    constexpr std::size_t kPerBlock = 32;
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
