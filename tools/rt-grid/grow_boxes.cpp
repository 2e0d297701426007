#include "tools/rt-grid/grow_boxes.h"

#include "tools/rt-grid/grow_exits.h"
#include "tools/rt-grid/lanes.h"
#include "tools/rt-grid/occupancy.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

namespace rt {
namespace {

constexpr int kLargestExtent = 31;
constexpr int kLargestStep = 16;
constexpr int kUsefulExtent = 8;  // what lies beyond it makes a box no better: coarser voxels are near
constexpr int kOpenSides = 2;     // of an inherited box in a brick
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

// How good a box is: goodness, which counts extents up to kUsefulExtent, above four bits that count those
// that are not 0. That of two extents side by side in a word, and by how much it changes when a box is seen
// from the next voxel above instead, are looked up.
class BoxRank {
public:
    static constexpr int kNone = -0x4000; ///< of no box: still negative after a step

    static int of(std::uint32_t box) {
        return kOfPairs[box & 1023] + kOfPairs[box >> 10 & 1023] + kOfPairs[box >> 20 & 1023];
    }
    /// Makes a box negative that does not contain the next voxel.
    static int changeBy(std::uint32_t pair) { return kChanges[pair]; }
    static int openSides(int rank) { return rank & 15; }

private:
    using Table = std::array<std::int16_t, 1024>;
    static constexpr int ofExtent(int extent) { return std::min(extent, kUsefulExtent) * 16 + (extent != 0); }
    static constexpr Table rankPairs() {
        Table ranks{};
        for (int i = 0; i < 1024; ++i)
            ranks[static_cast<std::size_t>(i)] =
                static_cast<std::int16_t>(ofExtent(i & 31) + ofExtent(i >> 5));
        return ranks;
    }
    static constexpr Table rankChanges() {
        Table changes{};
        for (int i = 0; i < 1024; ++i) {
            const int below = i & 31;
            const int above = i >> 5;
            const int change = ofExtent(std::min(below + 1, kLargestExtent)) - ofExtent(below) +
                               ofExtent(above - 1) - ofExtent(above);
            changes[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(above == 0 ? kNone : change);
        }
        return changes;
    }
    static const Table kOfPairs;
    static const Table kChanges;
};
constexpr BoxRank::Table BoxRank::kOfPairs = BoxRank::rankPairs();
constexpr BoxRank::Table BoxRank::kChanges = BoxRank::rankChanges();

// Grows a box round one voxel of a window: each face in turn moves by a step that doubles as long as the slab
// in front of it is empty, and halves when it is not.
class BoxGrower {
public:
    BoxGrower(const OccupancyWindow& window, const glm::ivec3& voxel, int margin)
        : window_(window), lo_(voxel), hi_(voxel), voxel_(voxel), margin_(margin),
          rows_(window.row(voxel.y, voxel.z)) {
        faces_.fill({margin > 0 ? 1 : 0, true});
    }
    Box grow() {
        unsigned moving = freeFaces(); // bit i: face i has not come to rest
        while (moving != 0) {
            for (unsigned left = moving; left != 0; left &= left - 1) {
                const int face = std::countr_zero(left);
                if (!moveFace(face)) moving &= ~(1u << face);
            }
        }
        return {voxel_ - lo_, hi_ - voxel_};
    }

private:
    struct Face {
        int step;
        bool growing; // the step still doubles
    };

    // Those with an empty voxel in front of them: most others rest from the start.
    unsigned freeFaces() const {
        if (margin_ == 0) return 0;
        const auto [x, y, z] = std::array{voxel_.x, voxel_.y, voxel_.z};
        const std::uint64_t occupied =
            (rows_ >> (x - 1) & 1) | (rows_ >> (x + 1) & 1) << 1 | (window_.row(y - 1, z) >> x & 1) << 2 |
            (window_.row(y + 1, z) >> x & 1) << 3 | (window_.row(y, z - 1) >> x & 1) << 4 |
            (window_.row(y, z + 1) >> x & 1) << 5;
        return static_cast<unsigned>(~occupied & 63);
    }
    // Returns false once the face has come to rest.
    bool moveFace(int number) {
        Face& face = faces_[static_cast<std::size_t>(number)];
        const int axis = number >> 1;
        const bool up = number & 1;
        if (tryStep(axis, up, face.step)) {
            face.step = face.growing ? std::min(2 * face.step, kLargestStep) : face.step / 2;
        } else {
            face.growing = false;
            face.step /= 2;
        }
        const int room = margin_ - (up ? hi_[axis] - voxel_[axis] : voxel_[axis] - lo_[axis]);
        face.step = std::min(face.step, room);
        return face.step != 0;
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
    std::array<Face, 6> faces_;
};

// A box and how good it is; none at first.
struct RankedBox {
    std::uint32_t word = 0;
    int rank = BoxRank::kNone;

    // Takes the box of the neighbour before the voxel along `axis`, seen from the voxel, if it is better.
    // Without branches that depend on the words: they would be guessed wrong.
    void inherit(std::uint32_t neighbour, int neighbourRank, int axis) {
        const int shift = 10 * axis;
        const std::uint32_t pair = neighbour >> shift & 1023u;
        const int seen = neighbourRank + BoxRank::changeBy(pair);
        const std::uint32_t box =
            neighbour - (32u << shift) + (std::uint32_t((pair & 31u) < kLargestExtent) << shift);
        word = seen > rank ? box : word;
        rank = std::max(seen, rank);
    }
};

// Gives the empty voxels of a block their boxes, x fastest: the best of those of the three neighbours before
// a voxel, or a new one where those are poor, since to grow one costs much more than to look at them.
class BlockGrower {
public:
    // The window shows the block and `margin` voxels round it. openSides: an inherited box must reach beyond
    // the voxel itself on so many sides.
    BlockGrower(const VoxelBlock& block, int openSides, const OccupancyWindow& window, int margin)
        : block_(block), openSides_(openSides), window_(window), margin_(margin) {}

    void grow() {
        const glm::ivec3& size = block_.size;
        std::fill_n(ranks_.begin(), size.x * size.y, std::int16_t(BoxRank::kNone));
        for (int z = 0; z < size.z; ++z)
            for (int y = 0; y < size.y; ++y) growRow(y, z);
    }

private:
    void growRow(int y, int z) {
        std::uint32_t* const row = block_.word({0, y, z});
        std::int16_t* const ranks = &ranks_[static_cast<std::size_t>(y * block_.size.x)];
        const std::uint64_t occupied = window_.row(y + margin_, z + margin_) >> margin_;
        RankedBox before;
        for (int x = 0; x < block_.size.x; ++x) {
            RankedBox best;
            if (!(occupied >> x & 1)) {
                best.inherit(before.word, before.rank, 0);
                if (y > 0) best.inherit(row[x - block_.rowStride], ranks[x - block_.size.x], 1);
                if (z > 0) best.inherit(row[x - block_.sliceStride], ranks[x], 2);
                if (best.rank < 0 || BoxRank::openSides(best.rank) < openSides_) growNew({x, y, z}, best);
                row[x] = best.word;
            }
            ranks[x] = static_cast<std::int16_t>(best.rank);
            before = best;
        }
    }
    void growNew(const glm::ivec3& voxel, RankedBox& best) const {
        const Box grown = BoxGrower(window_, voxel + block_.first, std::min(margin_, kLargestExtent)).grow();
        const std::uint32_t box = freeBoxWord(grown.below, grown.above);
        const int rank = BoxRank::of(box);
        if (rank > best.rank) best = {box, rank};
    }

    const VoxelBlock& block_;
    const int openSides_;
    const OccupancyWindow& window_;
    const int margin_;
    // Of the slice's voxels, and of the one before where this one has not come yet; kNone where occupied.
    std::array<std::int16_t, std::size_t(1) << (2 * kMaxBrickShift)> ranks_;
};

RT_WIDE_LANES void growBlock(const VoxelBlock& block, int openSides, const OccupancyWindow& window,
                             int margin) {
    BlockGrower(block, openSides, window, margin).grow();
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

// What a thread uses for one block after the other.
struct Workspace {
    OccupancyWindow window;
    ExitGrower exits;
};

void growGridTile(const Growth& growth, const glm::ivec3& first, Workspace& workspace) {
    OccupancyWindow& window = workspace.window;
    window.show(growth.occupancy, 0, first - kGridMargin, kGridTile + 2 * kGridMargin);
    const int reach = std::min(growth.exitReach, kGridMargin);
    const glm::ivec3 end = first + kGridTile;
    const glm::ivec3 around(std::max(reach - 1, 0));
    const VoxelBlock tile = gridBlock(growth, first, end, first - kGridMargin);
    const VoxelBlock known = gridBlock(growth, first - around, end + around, first - kGridMargin);
    growBlock(tile, kGridOpenSides, window, kGridMargin);
    workspace.exits.grow(window, tile, known, growth.nested.references.data(), reach);
}

void growBrick(const Growth& growth, const BrickPlace& place, Workspace& workspace) {
    const int side = 1 << place.shift;
    const int margin = marginFor(side);
    OccupancyWindow& window = workspace.window;
    window.show(growth.occupancy, place.level, place.first - margin, side + 2 * margin);
    const VoxelBlock block{growth.nested.bricks.data() + place.offset, glm::ivec3(side), side, side * side,
                           glm::ivec3(margin)};
    growBlock(block, kOpenSides, window, margin);
    workspace.exits.grow(window, block, growth.nested.references.data(), std::min(growth.exitReach, margin));
}

} // namespace

void growBoxes(NestedVoxels& nested, const glm::uvec3& dims, int exitReach, WorkMeter& meter) {
    const std::span<const std::uint32_t> bricks = nested.bricks;
    const Growth growth{
        nested,
        {glm::ivec3(dims), nested.voxels, bricks, OccupancyBits(nested.voxels), OccupancyBits(bricks)},
        exitReach};
    tbb::enumerable_thread_specific<Workspace> workspaces;
    const glm::ivec3 tiles = (glm::ivec3(dims) + (kGridTile - 1)) / kGridTile;
    const int tileCount = tiles.x * tiles.y * tiles.z;
    meter.begin(static_cast<std::uint64_t>(tileCount) + nested.places.size());
    tbb::parallel_for(0, tileCount, [&](int tile) {
        const glm::ivec3 at(tile % tiles.x, tile / tiles.x % tiles.y, tile / tiles.x / tiles.y);
        growGridTile(growth, at * kGridTile, workspaces.local());
        meter.add();
    });
    tbb::parallel_for(std::size_t(0), nested.places.size(), [&](std::size_t i) {
        growBrick(growth, nested.places[i], workspaces.local());
        meter.add();
    });
}

} // namespace rt
