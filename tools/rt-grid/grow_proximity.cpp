#include "tools/rt-grid/grow_proximity.h"

#include "formats/atlas.shared.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rt {
namespace {

constexpr std::uint32_t kFar =
    0x7FFFFFFEu; // stands for "none found yet"; one more does not set the occupied bit

std::uint32_t distanceOf(std::uint32_t word) {
    return word & kOccupiedBit ? 0u : word;
}

void lower(std::uint32_t& word, std::uint32_t neighbourDistance) {
    if (!(word & kOccupiedBit)) word = std::min(word, neighbourDistance + 1u);
}

// For each x, the smallest distance in row `row` among x-1, x, x+1.
void smallestOfThree(const std::uint32_t* row, std::size_t width, std::uint32_t* smallest) {
    for (std::size_t x = 0; x < width; ++x) smallest[x] = distanceOf(row[x]);
    std::uint32_t left = kFar;
    for (std::size_t x = 0; x + 1 < width; ++x) {
        const std::uint32_t here = smallest[x];
        smallest[x] = std::min({left, here, smallest[x + 1]});
        left = here;
    }
    smallest[width - 1] = std::min(left, smallest[width - 1]);
}

// Distances within one z slice (Rosenfeld & Pfaltz 1966).
void growInSlice(std::uint32_t* slice, std::size_t width, std::size_t height) {
    std::vector<std::uint32_t> smallest(width);
    const auto fromRow = [&](std::uint32_t* row, const std::uint32_t* neighbourRow) {
        smallestOfThree(neighbourRow, width, smallest.data());
        for (std::size_t x = 0; x < width; ++x) lower(row[x], smallest[x]);
    };
    for (std::size_t y = 0; y < height; ++y) {
        std::uint32_t* row = slice + y * width;
        if (y > 0) fromRow(row, row - width);
        for (std::size_t x = 1; x < width; ++x) lower(row[x], distanceOf(row[x - 1]));
    }
    for (std::size_t y = height; y-- > 0;) {
        std::uint32_t* row = slice + y * width;
        if (y + 1 < height) fromRow(row, row + width);
        for (std::size_t x = width - 1; x-- > 0;) lower(row[x], distanceOf(row[x + 1]));
    }
}

// Lowers a slice's distances to one more than the smallest of the nine neighbours in another slice.
void growFromSlice(std::uint32_t* slice, const std::uint32_t* from, std::size_t width, std::size_t height) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 32), [&](const auto& rows) {
        std::vector<std::uint32_t> column(width), smallest(width);
        for (std::size_t y = rows.begin(); y < rows.end(); ++y) {
            const std::uint32_t* middle = from + y * width;
            const std::uint32_t* below = y > 0 ? middle - width : middle;
            const std::uint32_t* above = y + 1 < height ? middle + width : middle;
            for (std::size_t x = 0; x < width; ++x)
                column[x] = std::min({distanceOf(below[x]), distanceOf(middle[x]), distanceOf(above[x])});
            smallestOfThree(column.data(), width, smallest.data());
            for (std::size_t x = 0; x < width; ++x) lower(slice[y * width + x], smallest[x]);
        }
    });
}

} // namespace

std::vector<std::uint32_t> growProximity(std::vector<std::uint32_t> voxels, const glm::uvec3& dims) {
    const std::size_t width = dims.x;
    const std::size_t height = dims.y;
    const std::size_t sliceSize = width * height;
    tbb::parallel_for(0u, dims.z, [&](unsigned z) {
        std::uint32_t* slice = voxels.data() + z * sliceSize;
        std::replace(slice, slice + sliceSize, 0u, kFar);
        growInSlice(slice, width, height);
    });
    // A step to the next slice may move by one in x and y too, so after k slices the nine-neighbour minimum
    // has seen every voxel within k: max(k, distance in that slice) is reached, which is the chessboard
    // distance.
    for (unsigned z = 1; z < dims.z; ++z)
        growFromSlice(voxels.data() + z * sliceSize, voxels.data() + (z - 1) * sliceSize, width, height);
    for (unsigned z = dims.z - 1; z-- > 0;)
        growFromSlice(voxels.data() + z * sliceSize, voxels.data() + (z + 1) * sliceSize, width, height);
    return voxels;
}

} // namespace rt
