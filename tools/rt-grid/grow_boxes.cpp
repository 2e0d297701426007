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
constexpr int kBlindSides = 2;   // an inherited box may end at the voxel itself on so many sides
constexpr int kGridTile = 8;     // voxels of the grid are grown in cubes of so many

// A brick's surroundings that its boxes can see, in its own voxels.
int marginFor(int side) {
    return std::min((OccupancyWindow::kLargestSide - side) / 2, 2 * side);
}

struct Box {
    glm::ivec3 below{0};
    glm::ivec3 above{0};
};

// For two extents of a word: how good they are, and how many of them are 0.
struct PairScore {
    std::uint8_t score;
    std::uint8_t zeros;
};

constexpr std::array<PairScore, 1024> makePairScores() {
    std::array<PairScore, 1024> scores{};
    for (int i = 0; i < 1024; ++i) {
        const int a = i & 31;
        const int b = i >> 5;
        scores[static_cast<std::size_t>(i)] = {
            static_cast<std::uint8_t>(std::min(a, kUsefulExtent) + std::min(b, kUsefulExtent)),
            static_cast<std::uint8_t>((a == 0) + (b == 0))};
    }
    return scores;
}
constexpr std::array<PairScore, 1024> kPairScores = makePairScores();

int scoreOf(std::uint32_t box) {
    return kPairScores[box & 1023].score + kPairScores[box >> 10 & 1023].score + kPairScores[box >> 20].score;
}
int zerosOf(std::uint32_t box) {
    return kPairScores[box & 1023].zeros + kPairScores[box >> 10 & 1023].zeros + kPairScores[box >> 20].zeros;
}

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

std::uint32_t grownBox(const OccupancyWindow& window, const glm::ivec3& voxel, int margin) {
    const Box box = BoxGrower(window, voxel, std::min(margin, kLargestExtent)).grow();
    return freeBoxWord(box.below, box.above);
}

void growGridTile(NestedVoxels& nested, const NestedOccupancy& occupancy, const glm::ivec3& first,
                  OccupancyWindow& window) {
    constexpr int kMargin = (OccupancyWindow::kLargestSide - kGridTile) / 2;
    window.show(occupancy, 0, first - kMargin, OccupancyWindow::kLargestSide);
    const glm::ivec3 end = glm::min(first + kGridTile, occupancy.dims);
    for (int z = first.z; z < end.z; ++z)
        for (int y = first.y; y < end.y; ++y)
            for (int x = first.x; x < end.x; ++x) {
                const std::size_t i = occupancy.indexOf({x, y, z});
                if (occupancy.voxelBits.at(i)) continue;
                nested.voxels[i] = grownBox(window, glm::ivec3(x, y, z) - first + kMargin, kMargin);
            }
}

// The box of the neighbour before it along `axis`, if it contains this voxel too, seen from this voxel.
bool inherit(std::uint32_t neighbour, int axis, std::uint32_t& box) {
    if (neighbour & kOccupiedBit) return false;
    const int shift = 10 * axis;
    if ((neighbour >> (shift + 5) & 31u) == 0) return false;
    box = neighbour - (32u << shift);
    if ((box >> shift & 31u) < kLargestExtent) box += 1u << shift;
    return true;
}

// Growing a box costs much more than looking at three neighbours, and theirs is nearly as good as a new one.
void growBrick(NestedVoxels& nested, const NestedOccupancy& occupancy, const BrickPlace& place,
               OccupancyWindow& window) {
    const int side = 1 << place.shift;
    const int margin = marginFor(side);
    window.show(occupancy, place.level, place.first - margin, side + 2 * margin);
    std::uint32_t* word = nested.bricks.data() + place.offset;
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x, ++word) {
                if (window.row(y + margin, z + margin) >> (x + margin) & 1) continue;
                std::uint32_t best = 0;
                int bestScore = -1;
                const auto consider = [&](int axis, int at, int stride) {
                    std::uint32_t box = 0;
                    if (at == 0 || !inherit(word[-stride], axis, box)) return;
                    const int score = scoreOf(box);
                    if (score > bestScore) bestScore = score, best = box;
                };
                consider(0, x, 1);
                consider(1, y, side);
                consider(2, z, side * side);
                if (bestScore < 0 || zerosOf(best) > kBlindSides) {
                    const std::uint32_t box = grownBox(window, glm::ivec3(x, y, z) + margin, margin);
                    if (scoreOf(box) > bestScore) best = box;
                }
                *word = best;
            }
}

} // namespace

void growBoxes(NestedVoxels& nested, const glm::uvec3& dims) {
    const std::span<const std::uint32_t> bricks(nested.bricks.data(), nested.bricks.size);
    const NestedOccupancy occupancy{glm::ivec3(dims), nested.voxels, bricks, OccupancyBits(nested.voxels),
                                    OccupancyBits(bricks)};
    const glm::ivec3 tiles = (glm::ivec3(dims) + (kGridTile - 1)) / kGridTile;
    tbb::parallel_for(0, tiles.x * tiles.y * tiles.z, [&](int tile) {
        OccupancyWindow window;
        const glm::ivec3 at(tile % tiles.x, tile / tiles.x % tiles.y, tile / tiles.x / tiles.y);
        growGridTile(nested, occupancy, at * kGridTile, window);
    });
    tbb::parallel_for(std::size_t(0), nested.places.size(), [&](std::size_t i) {
        OccupancyWindow window;
        growBrick(nested, occupancy, nested.places[i], window);
    });
}

} // namespace rt
