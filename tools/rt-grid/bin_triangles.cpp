#include "tools/rt-grid/bin_triangles.h"

#include "common/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <utility>

namespace rt {
namespace {

constexpr std::size_t kTrianglesPerChunk = 1024;
constexpr std::size_t kVoxelsPerBlock = 1u << 16;

// The voxels that some consecutive triangles meet, triangle by triangle.
struct ChunkVoxels {
    std::vector<std::uint32_t> voxels;
    std::vector<std::uint32_t> countOfTriangle;
};

std::size_t chunkCount(std::size_t items, std::size_t perChunk) {
    return (items + perChunk - 1) / perChunk;
}

template <class Body>
void forEachBlock(std::size_t voxelCount, Body&& body) {
    tbb::parallel_for(std::size_t(0), chunkCount(voxelCount, kVoxelsPerBlock), [&](std::size_t block) {
        body(block, block * kVoxelsPerBlock, std::min(voxelCount, (block + 1) * kVoxelsPerBlock));
    });
}

RT_WIDE_LANES ChunkVoxels voxelizeChunk(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                                        std::atomic<std::uint64_t>& total, const ReferenceLimit& limit) {
    ChunkVoxels chunk;
    chunk.countOfTriangle.reserve(triangles.size());
    const VoxelSpace space(layout);
    std::size_t reported = 0;
    const auto report = [&] {
        const std::uint64_t more = chunk.voxels.size() - reported;
        if (total.fetch_add(more, std::memory_order_relaxed) + more > limit.references)
            throw Error(ErrorKind::LimitExceeded, limit.message);
        reported = chunk.voxels.size();
    };
    for (const TriangleRecord& triangle : triangles) {
        const std::size_t before = chunk.voxels.size();
        forEachVoxelOf(space.of(triangle), layout.dims, layout.padCells, [&](std::uint32_t voxel) {
            chunk.voxels.push_back(voxel);
            // One giant triangle must not fill the memory before anyone counts.
            if (chunk.voxels.size() - reported == kVoxelsPerBlock) report();
        });
        chunk.countOfTriangle.push_back(static_cast<std::uint32_t>(chunk.voxels.size() - before));
    }
    report();
    chunk.voxels.shrink_to_fit();
    return chunk;
}

std::vector<ChunkVoxels> voxelizeAll(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                                     const ReferenceLimit& limit, WorkMeter& meter) {
    std::vector<ChunkVoxels> chunks(chunkCount(triangles.size(), kTrianglesPerChunk));
    meter.begin(2 * chunks.size()); // and again when they go into the lists
    std::atomic<std::uint64_t> total{0};
    tbb::parallel_for(std::size_t(0), chunks.size(), [&](std::size_t i) {
        const std::size_t first = i * kTrianglesPerChunk;
        const std::size_t count = std::min(kTrianglesPerChunk, triangles.size() - first);
        chunks[i] = voxelizeChunk(triangles.subspan(first, count), layout, total, limit);
        meter.add();
    });
    return chunks;
}

void countReferences(const std::vector<ChunkVoxels>& chunks, std::vector<std::uint32_t>& counts) {
    tbb::parallel_for(std::size_t(0), chunks.size(), [&](std::size_t i) {
        for (std::uint32_t voxel : chunks[i].voxels)
            std::atomic_ref(counts[voxel]).fetch_add(1, std::memory_order_relaxed);
    });
}

struct BlockTotals {
    std::uint64_t occupied = 0;
    std::uint64_t references = 0;
    std::uint64_t words() const { return kListHeaderWords * occupied + references; }
};

// Turns the counts in refs.voxels into the lists' offsets and makes room for the lists.
void placeLists(CellRefs& refs) {
    std::vector<BlockTotals> totals(chunkCount(refs.voxels.size(), kVoxelsPerBlock));
    forEachBlock(refs.voxels.size(), [&](std::size_t block, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            totals[block].occupied += refs.voxels[i] > 0;
            totals[block].references += refs.voxels[i];
        }
    });
    std::vector<std::uint64_t> firstWord(totals.size());
    std::uint64_t words = 0;
    for (std::size_t block = 0; block < totals.size(); ++block) {
        firstWord[block] = words;
        words += totals[block].words();
        refs.occupiedVoxels += totals[block].occupied;
        refs.referenceCount += totals[block].references;
    }
    assert(words <= kMaxReferenceWords);
    refs.references.resize(words);
    forEachBlock(refs.voxels.size(), [&](std::size_t block, std::size_t first, std::size_t last) {
        auto offset = static_cast<std::uint32_t>(firstWord[block]);
        for (std::size_t i = first; i < last; ++i) {
            const std::uint32_t count = refs.voxels[i];
            if (count == 0) continue;
            refs.voxels[i] = leafWord(offset);
            offset += kListHeaderWords + count;
        }
    });
}

// Puts one chunk's triangles into the lists. The word of a list's exit box says, until all are
// filled, how many of its places are taken;
// threads take places in any order. Both reads miss the caches as a rule and an atomic lets nothing overtake
// it, so the memory is asked for well before it is needed.
void fillFromChunk(const ChunkVoxels& chunk, std::uint32_t triangle, CellRefs& refs) {
    constexpr std::size_t kAhead = 16;
    const std::vector<std::uint32_t>& voxels = chunk.voxels;
    const auto listOf = [&](std::size_t i) { return leafList(refs.voxels[voxels[i]]); };
    std::size_t i = 0;
    for (const std::uint32_t count : chunk.countOfTriangle) {
        for (const std::size_t end = i + count; i < end; ++i) {
            if (i + 2 * kAhead < voxels.size()) {
                __builtin_prefetch(&refs.voxels[voxels[i + 2 * kAhead]]);
                __builtin_prefetch(&refs.references[listOf(i + kAhead)], 1);
            }
            const std::uint32_t list = listOf(i);
            const std::uint32_t place =
                std::atomic_ref(refs.references[list]).fetch_add(1, std::memory_order_relaxed);
            refs.references[list + kListHeaderWords + place] = triangle;
        }
        ++triangle;
    }
}

void fillLists(const std::vector<ChunkVoxels>& chunks, CellRefs& refs, WorkMeter& meter) {
    tbb::parallel_for(std::size_t(0), chunks.size(), [&](std::size_t i) {
        fillFromChunk(chunks[i], static_cast<std::uint32_t>(i * kTrianglesPerChunk), refs);
        meter.add();
    });
    forEachBlock(refs.voxels.size(), [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (refs.voxels[i] == 0) continue;
            const auto list = refs.references.begin() + leafList(refs.voxels[i]);
            const std::uint32_t count = std::exchange(*list, 0);
            std::sort(list + kListHeaderWords, list + kListHeaderWords + count);
            list[count] |= kLastInList;
        }
    });
}

} // namespace

CellRefs binTriangles(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                      const ReferenceLimit& limit, WorkMeter& meter) {
    const std::vector<ChunkVoxels> chunks = voxelizeAll(triangles, layout, limit, meter);
    CellRefs refs;
    refs.voxels.resize(std::size_t(layout.dims.x) * layout.dims.y * layout.dims.z);
    countReferences(chunks, refs.voxels);
    placeLists(refs);
    fillLists(chunks, refs, meter);
    return refs;
}

} // namespace rt
