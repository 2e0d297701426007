#include "tools/rt-grid/grow_boxes.h"

#include "tools/rt-grid/occupancy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

constexpr int kLargestExtent = 31;
constexpr int kLargestStep = 16;
constexpr int kUsefulExtent = 8; // what lies beyond it makes a box no better: coarser voxels are near
constexpr int kBlindSides = 3;   // an inherited box may end at the voxel itself on so many sides
constexpr int kGridTile = 8;     // voxels of the grid are grown in cubes of so many

// How far beyond a brick its boxes can see, in its own voxels. Twice as far: 2 % fewer steps per ray on the
// dragon, for half as much time again.
int marginFor(int side) {
    return std::min((OccupancyWindow::kLargestSide - side) / 2, side);
}

struct Box {
    glm::ivec3 below{0};
    glm::ivec3 above{0};
};

// How good a box is, in the low byte, and how many of its six extents are 0, above.
class BoxScore {
public:
    explicit BoxScore(std::uint32_t box)
        : sum_(kOfPairs[box & 1023] + kOfPairs[box >> 10 & 1023] + kOfPairs[box >> 20]) {}
    int goodness() const { return sum_ & 255; }
    int zeros() const { return sum_ >> 8; }

private:
    static constexpr std::array<std::uint16_t, 1024> scorePairs() {
        std::array<std::uint16_t, 1024> scores{};
        for (int i = 0; i < 1024; ++i) {
            const int a = i & 31;
            const int b = i >> 5;
            const int zeros = (a == 0) + (b == 0);
            scores[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
                std::min(a, kUsefulExtent) + std::min(b, kUsefulExtent) + (zeros << 8));
        }
        return scores;
    }
    static const std::array<std::uint16_t, 1024> kOfPairs; // of two extents side by side in a word
    int sum_;
};
constexpr std::array<std::uint16_t, 1024> BoxScore::kOfPairs = BoxScore::scorePairs();

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

// The box of the neighbour before it along `axis`, if it contains this voxel too, seen from this voxel.
bool inherit(std::uint32_t neighbour, int axis, std::uint32_t& box) {
    if (neighbour & kOccupiedBit) return false;
    const int shift = 10 * axis;
    if ((neighbour >> (shift + 5) & 31u) == 0) return false;
    box = neighbour - (32u << shift);
    if ((box >> shift & 31u) < kLargestExtent) box += 1u << shift;
    return true;
}

// A block of voxels of one size, side by side in memory along x.
struct Region {
    std::uint32_t* words;
    glm::ivec3 size;
    std::ptrdiff_t rowStride;
    std::ptrdiff_t sliceStride;
    bool inherits; // boxes of neighbours will do
};

// The best of the boxes of the three neighbours before the voxel, or a new one where those are poor: growing
// one costs much more than looking at them.
std::uint32_t boxFor(const Region& region, const glm::ivec3& voxel, const std::uint32_t* word,
                     const OccupancyWindow& window, int margin) {
    std::uint32_t best = 0;
    int bestScore = -1;
    int bestZeros = 6;
    const auto consider = [&](int axis, std::ptrdiff_t stride) {
        std::uint32_t box = 0;
        if (voxel[axis] == 0 || !inherit(word[-stride], axis, box)) return;
        const BoxScore score(box);
        if (score.goodness() <= bestScore) return;
        best = box;
        bestScore = score.goodness();
        bestZeros = score.zeros();
    };
    if (region.inherits) {
        consider(0, 1);
        consider(1, region.rowStride);
        consider(2, region.sliceStride);
    }
    if (bestZeros <= kBlindSides) return best;
    const Box grown = BoxGrower(window, voxel + margin, std::min(margin, kLargestExtent)).grow();
    const std::uint32_t box = freeBoxWord(grown.below, grown.above);
    return BoxScore(box).goodness() > bestScore ? box : best;
}

// The window shows the region and `margin` voxels round it.
void growRegion(const Region& region, const OccupancyWindow& window, int margin) {
    for (int z = 0; z < region.size.z; ++z)
        for (int y = 0; y < region.size.y; ++y) {
            std::uint32_t* const row = region.words + z * region.sliceStride + y * region.rowStride;
            const std::uint64_t occupied = window.row(y + margin, z + margin) >> margin;
            for (int x = 0; x < region.size.x; ++x)
                if (!(occupied >> x & 1)) row[x] = boxFor(region, {x, y, z}, row + x, window, margin);
        }
}

void growGridTile(NestedVoxels& nested, const NestedOccupancy& occupancy, const glm::ivec3& first) {
    constexpr int kMargin = (OccupancyWindow::kLargestSide - kGridTile) / 2;
    OccupancyWindow window;
    window.show(occupancy, 0, first - kMargin, OccupancyWindow::kLargestSide);
    const std::ptrdiff_t rowStride = occupancy.dims.x;
    growRegion({nested.voxels.data() + occupancy.indexOf(first),
                glm::min(glm::ivec3(kGridTile), occupancy.dims - first), rowStride,
                rowStride * occupancy.dims.y, false},
               window, kMargin);
}

void growBrick(NestedVoxels& nested, const NestedOccupancy& occupancy, const BrickPlace& place) {
    const int side = 1 << place.shift;
    const int margin = marginFor(side);
    OccupancyWindow window;
    window.show(occupancy, place.level, place.first - margin, side + 2 * margin);
    growRegion({nested.bricks.data() + place.offset, glm::ivec3(side), side, side * side, true}, window,
               margin);
}

} // namespace

void growBoxes(NestedVoxels& nested, const glm::uvec3& dims) {
    const std::span<const std::uint32_t> bricks(nested.bricks.data(), nested.bricks.size);
    const NestedOccupancy occupancy{glm::ivec3(dims), nested.voxels, bricks, OccupancyBits(nested.voxels),
                                    OccupancyBits(bricks)};
    const glm::ivec3 tiles = (glm::ivec3(dims) + (kGridTile - 1)) / kGridTile;
    tbb::parallel_for(0, tiles.x * tiles.y * tiles.z, [&](int tile) {
        const glm::ivec3 at(tile % tiles.x, tile / tiles.x % tiles.y, tile / tiles.x / tiles.y);
        growGridTile(nested, occupancy, at * kGridTile);
    });
    tbb::parallel_for(std::size_t(0), nested.places.size(),
                      [&](std::size_t i) { growBrick(nested, occupancy, nested.places[i]); });
}

} // namespace rt
