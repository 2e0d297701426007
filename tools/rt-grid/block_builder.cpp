#include "tools/rt-grid/block_builder.h"

#include "common/error.h"
#include "tools/rt-grid/fresh_array.h"
#include "tools/rt-grid/leaf_relations.h"

#include <algorithm>
#include <array>
#include <utility>

namespace rt {
namespace {

constexpr std::size_t kBatch =
    16; // triangles that are asked from memory, and whose boxes are found, together
constexpr double kLargestSpread =
    2.0; // voxels that a triangle meets on average where a brick parts triangles

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

} // namespace

void WordBudget::take(std::uint64_t words) {
    if (used_.fetch_add(words, std::memory_order_relaxed) + words > limit_.references)
        throw Error(ErrorKind::LimitExceeded, limit_.message);
}

Nesting nestingOf(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                  const NestOptions& options, WordBudget& budget) {
    const glm::uvec3& dims = layout.dims;
    return {triangles, layout, options,
            BrickCost(triangles, layout.cellsPerUnit, options.wordCost,
                      finestLevelOf(std::max({dims.x, dims.y, dims.z}))),
            budget};
}

class BlockBuilder::State {
public:
    explicit State(const Nesting& nesting) : nesting_(nesting), words_(nesting.budget) {}

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

BlockBuilder::BlockBuilder(const Nesting& nesting) : state_(std::make_unique<State>(nesting)) {}
BlockBuilder::~BlockBuilder() = default;

Block BlockBuilder::build(const CellRefs& grid, std::span<std::uint32_t> voxels, std::size_t first) {
    return state_->build(grid, voxels, first);
}

std::uint64_t BlockBuilder::wordsTaken() const {
    return state_->wordsTaken();
}

} // namespace rt
