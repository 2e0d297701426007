#include "tools/rt-grid/count_voxels.h"

#include "tools/rt-grid/bin_triangles.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <bit>

namespace rt {
namespace {

constexpr std::size_t kTrianglesPerChunk = 1024;

// Sets the bits of the voxels that triangles meet. Returns how many references that is.
RT_WIDE_LANES std::uint64_t mark(std::span<const TriangleRecord> triangles, const GridLayout& layout,
                                 std::vector<std::uint64_t>& bits) {
    const VoxelSpace space(layout);
    std::uint64_t references = 0;
    for (const TriangleRecord& triangle : triangles)
        forEachVoxelOf(space.of(triangle), layout.dims, layout.padCells, [&](std::uint32_t voxel) {
            ++references;
            const std::uint64_t bit = std::uint64_t(1) << (voxel & 63);
            const std::atomic_ref word(bits[voxel >> 6]);
            if (!(word.load(std::memory_order_relaxed) & bit)) word.fetch_or(bit, std::memory_order_relaxed);
        });
    return references;
}

} // namespace

VoxelCount countVoxels(std::span<const TriangleRecord> triangles, const GridLayout& layout) {
    const std::uint64_t voxels = std::uint64_t(layout.dims.x) * layout.dims.y * layout.dims.z;
    std::vector<std::uint64_t> bits((voxels + 63) / 64);
    std::atomic<std::uint64_t> references{0};
    const std::size_t chunks = (triangles.size() + kTrianglesPerChunk - 1) / kTrianglesPerChunk;
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t i) {
        const std::size_t first = i * kTrianglesPerChunk;
        const std::size_t count = std::min(kTrianglesPerChunk, triangles.size() - first);
        references += mark(triangles.subspan(first, count), layout, bits);
    });
    VoxelCount count;
    count.references = references;
    for (const std::uint64_t word : bits) count.occupied += static_cast<unsigned>(std::popcount(word));
    return count;
}

} // namespace rt
