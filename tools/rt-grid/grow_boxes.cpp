#include "tools/rt-grid/grow_boxes.h"

#include "tools/rt-grid/grow_exits.h"
#include "tools/rt-grid/occupancy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

constexpr int kLargestExtent = 31;
constexpr int kLargestStep = 16;
constexpr int kUsefulExtent = 8;  // what lies beyond it makes a box no better: coarser voxels are near
constexpr int kOpenSides = 3;     // of an inherited box in a brick
constexpr int kGridOpenSides = 6; // of one in the grid: long rays pass there; 3: 2 % more steps per ray
constexpr int kGridTile = 8;      // voxels of the grid are grown in cubes of so many
constexpr int kGridMargin = 16;   // and see so many beyond; 28: 0.7 % fewer steps per ray on the dragon

// How far beyond a brick its boxes can see, in its own voxels. Twice as far: 2 % fewer steps per ray on the
// dragon, for half as much time again.
int marginFor(int side) {
    return std::min((OccupancyWindow::kLargestSide - side) / 2, side);
}

struct Box {
    glm::ivec3 below{0};
    glm::ivec3 above{0};
};

// How good a box is: twelve bits of goodness above four that count the extents that are not 0.
class BoxRank {
public:
    static int of(std::uint32_t box) {
        return kOfPairs[box & 1023] + kOfPairs[box >> 10 & 1023] + kOfPairs[box >> 20 & 1023];
    }
    static int openSides(int rank) { return rank & 15; }

private:
    static constexpr std::array<std::uint16_t, 1024> rankPairs() {
        std::array<std::uint16_t, 1024> ranks{};
        for (int i = 0; i < 1024; ++i) {
            const int a = i & 31;
            const int b = i >> 5;
            const int goodness = std::min(a, kUsefulExtent) + std::min(b, kUsefulExtent);
            ranks[static_cast<std::size_t>(i)] =
                static_cast<std::uint16_t>(goodness * 16 + (a != 0) + (b != 0));
        }
        return ranks;
    }
    static const std::array<std::uint16_t, 1024> kOfPairs; // of two extents side by side in a word
};
constexpr std::array<std::uint16_t, 1024> BoxRank::kOfPairs = BoxRank::rankPairs();

// Grows a box round one voxel of a window: each face in turn moves by a step that doubles as long as the slab
// in front of it is empty, and halves when it is not.
class BoxGrower {
public:
    BoxGrower(const OccupancyWindow& window, const glm::ivec3& voxel, int margin)
        : window_(window), lo_(voxel), hi_(voxel), voxel_(voxel), margin_(margin),
          rows_(window.row(voxel.y, voxel.z)) {
        step_.fill(1);
        growing_.fill(true);
    }
    Box grow() {
        for (bool any = true; any;) {
            any = false;
            for (int face = 0; face < 6; ++face) any = tryFace(face) || any;
        }
        return {voxel_ - lo_, hi_ - voxel_};
    }

private:
    // Returns false once the face has come to rest.
    bool tryFace(int face) {
        int& step = step_[static_cast<std::size_t>(face)];
        if (step == 0) return false;
        const int axis = face >> 1;
        const bool up = face & 1;
        const int room = margin_ - (up ? hi_[axis] - voxel_[axis] : voxel_[axis] - lo_[axis]);
        step = std::min(step, room);
        if (step == 0) return false;
        bool& growing = growing_[static_cast<std::size_t>(face)];
        if (tryStep(axis, up, step)) {
            step = growing ? std::min(2 * step, kLargestStep) : step / 2;
        } else {
            growing = false;
            step /= 2;
        }
        return true;
    }
    bool tryStep(int axis, bool up, int step) {
        const int from = up ? hi_[axis] + 1 : lo_[axis] - step;
        const int to = from + step - 1;
        if (axis == 0) {
            if (rows_ & bits(from, to)) return false;
        } else {
            const std::uint64_t slab =
                axis == 1 ? window_.rowsIn(from, to, lo_.z, hi_.z) : window_.rowsIn(lo_.y, hi_.y, from, to);
            if (slab & bits(lo_.x, hi_.x)) return false;
            rows_ |= slab;
        }
        (up ? hi_ : lo_)[axis] = up ? to : from;
        return true;
    }
    static std::uint64_t bits(int from, int to) { return (~std::uint64_t(0) >> (63 - (to - from))) << from; }

    const OccupancyWindow& window_;
    glm::ivec3 lo_, hi_, voxel_;
    int margin_;
    std::uint64_t rows_; // all rows of the box in one
    std::array<int, 6> step_;
    std::array<bool, 6> growing_;
};

// The box of the neighbour before it along `axis`, seen from this voxel, and its rank; -1 if the neighbour is
// occupied or its box does not contain this voxel. Without branches that depend on the words: they would be
// guessed wrong.
int inherit(std::uint32_t neighbour, int axis, std::uint32_t& box) {
    const int shift = 10 * axis;
    const std::uint32_t below = neighbour >> shift & 31u;
    const std::uint32_t above = neighbour >> (shift + 5) & 31u;
    box = neighbour - (32u << shift) + (std::uint32_t(below < kLargestExtent) << shift);
    const int rank = BoxRank::of(box);
    return (above == 0) | ((neighbour & kOccupiedBit) != 0) ? -1 : rank;
}

// The best of the boxes of the three neighbours before the voxel, or a new one where those are poor: growing
// one costs much more than looking at them.
std::uint32_t boxFor(const VoxelBlock& block, int openSides, const glm::ivec3& voxel,
                     const std::uint32_t* word, const OccupancyWindow& window, int margin) {
    std::uint32_t best = 0;
    int bestRank = -1;
    const auto consider = [&](int axis, std::ptrdiff_t stride) {
        if (voxel[axis] == 0) return;
        std::uint32_t box = 0;
        const int rank = inherit(word[-stride], axis, box);
        best = rank > bestRank ? box : best;
        bestRank = std::max(rank, bestRank);
    };
    consider(0, 1);
    consider(1, block.rowStride);
    consider(2, block.sliceStride);
    if (bestRank >= 0 && BoxRank::openSides(bestRank) >= openSides) return best;
    const Box grown = BoxGrower(window, voxel + block.first, std::min(margin, kLargestExtent)).grow();
    const std::uint32_t box = freeBoxWord(grown.below, grown.above);
    return BoxRank::of(box) > bestRank ? box : best;
}

// The window shows the block and `margin` voxels round it. openSides: an inherited box must reach beyond the
// voxel itself on so many sides.
void growBlock(const VoxelBlock& block, int openSides, const OccupancyWindow& window, int margin) {
    for (int z = 0; z < block.size.z; ++z)
        for (int y = 0; y < block.size.y; ++y) {
            std::uint32_t* const row = block.word({0, y, z});
            const std::uint64_t occupied = window.row(y + margin, z + margin) >> margin;
            for (int x = 0; x < block.size.x; ++x)
                if (!(occupied >> x & 1))
                    row[x] = boxFor(block, openSides, {x, y, z}, row + x, window, margin);
        }
}

// What all blocks have in common.
struct Growth {
    NestedVoxels& nested;
    NestedOccupancy occupancy;
    int exitReach;
};

VoxelBlock gridBlock(const Growth& growth, const glm::ivec3& lo, const glm::ivec3& hi,
                     const glm::ivec3& windowFirst) {
    const glm::ivec3& dims = growth.occupancy.dims;
    const glm::ivec3 first = glm::max(lo, glm::ivec3(0));
    return {growth.nested.voxels.data() + growth.occupancy.indexOf(first), glm::min(hi, dims) - first, dims.x,
            std::ptrdiff_t(dims.x) * dims.y, first - windowFirst};
}

void growGridTile(const Growth& growth, const glm::ivec3& first) {
    OccupancyWindow window;
    window.show(growth.occupancy, 0, first - kGridMargin, kGridTile + 2 * kGridMargin);
    const int reach = std::min(growth.exitReach, kGridMargin);
    const glm::ivec3 end = first + kGridTile;
    const glm::ivec3 around(std::max(reach - 1, 0));
    const VoxelBlock tile = gridBlock(growth, first, end, first - kGridMargin);
    const VoxelBlock known = gridBlock(growth, first - around, end + around, first - kGridMargin);
    growBlock(tile, kGridOpenSides, window, kGridMargin);
    growExits(window, tile, known, growth.nested.references.data(), reach);
}

void growBrick(const Growth& growth, const BrickPlace& place) {
    const int side = 1 << place.shift;
    const int margin = marginFor(side);
    OccupancyWindow window;
    window.show(growth.occupancy, place.level, place.first - margin, side + 2 * margin);
    const VoxelBlock block{growth.nested.bricks.data() + place.offset, glm::ivec3(side), side, side * side,
                           glm::ivec3(margin)};
    growBlock(block, kOpenSides, window, margin);
    growExits(window, block, block, growth.nested.references.data(), std::min(growth.exitReach, margin));
}

} // namespace

void growBoxes(NestedVoxels& nested, const glm::uvec3& dims, int exitReach) {
    const std::span<const std::uint32_t> bricks(nested.bricks.data(), nested.bricks.size);
    const Growth growth{
        nested,
        {glm::ivec3(dims), nested.voxels, bricks, OccupancyBits(nested.voxels), OccupancyBits(bricks)},
        exitReach};
    const glm::ivec3 tiles = (glm::ivec3(dims) + (kGridTile - 1)) / kGridTile;
    tbb::parallel_for(0, tiles.x * tiles.y * tiles.z, [&](int tile) {
        const glm::ivec3 at(tile % tiles.x, tile / tiles.x % tiles.y, tile / tiles.x / tiles.y);
        growGridTile(growth, at * kGridTile);
    });
    tbb::parallel_for(std::size_t(0), nested.places.size(),
                      [&](std::size_t i) { growBrick(growth, nested.places[i]); });
}

} // namespace rt
