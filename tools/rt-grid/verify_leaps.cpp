#include "tools/rt-grid/verify_leaps.h"

#include "tools/rt-grid/occupancy_sums.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <optional>

namespace rt {
namespace {

constexpr std::size_t kVoxelsPerBlock = 4096;

std::uint32_t firstTriangle(const Atlas& atlas, std::uint32_t leaf) {
    return atlas.references[leafList(leaf) + kListHeaderWords] & ~kLastInList;
}

// "leaps to voxel (1, 2, 3) of level 0, which lists triangle 7"
std::string obstacleIn(const Atlas& atlas, const CellBox& box) {
    std::string text;
    forEachLeafIn(atlas, box, [&](std::uint32_t word, const CellPlace& place) {
        text = fmt::format("{}, which lists triangle {}", nameOf(place), firstTriangle(atlas, word));
        return false;
    });
    return text;
}

CellBox cubeRound(const CellPlace& place, int radius) {
    return {place.at - radius, place.at + radius, place.level};
}

class DistanceProof {
public:
    DistanceProof(const Atlas& atlas) : atlas_(atlas) {
        const CellBlock grid = gridBlock(atlas);
        sums_.count(atlas, {glm::ivec3(0), grid.dims - 1, 0});
    }
    void check(const CellPlace& place, std::uint32_t word, Faults& faults) const {
        const auto distance = static_cast<int>(word);
        const CellBox leapt = cubeRound(place, distance - 1);
        if (sums_.in(leapt) != 0)
            faults.add([&] {
                return fmt::format("the distance {} of empty {} lets rays leap over {}", distance,
                                   nameOf(place), obstacleIn(atlas_, leapt));
            });
        else if (sums_.in(cubeRound(place, distance)) == 0)
            faults.add([&] {
                return fmt::format("the distance {} of empty {} is too short: nothing is that near", distance,
                                   nameOf(place));
            });
    }

private:
    const Atlas& atlas_;
    OccupancySums sums_;
};

// The boxes of one block of voxels.
class BoxProof {
public:
    BoxProof(const Atlas& atlas, const CellBlock& block, const OccupancySums& sums, Faults& faults)
        : atlas_(atlas), block_(block), sums_(sums), faults_(faults) {}

    /// Returns how many boxes there are.
    std::uint64_t check(std::size_t begin, std::size_t end) {
        std::uint64_t boxes = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t word = block_.words[i];
            if (isBrick(word)) continue;
            ++boxes;
            if (word & kOccupiedBit)
                checkLeaf(block_.place(i), word);
            else
                checkEmpty(block_.place(i), word);
        }
        return boxes;
    }

private:
    void checkEmpty(const CellPlace& place, std::uint32_t word) {
        const CellBox box = freeBoxOf(word, place);
        if (sums_.in(box) == 0) return;
        faults_.add([&] {
            return fmt::format("the box of empty {} holds {}", nameOf(place), obstacleIn(atlas_, box));
        });
    }
    void checkLeaf(const CellPlace& place, std::uint32_t word) {
        const std::uint32_t* const list = &atlas_.references[leafList(word)];
        const CellBox box = freeBoxOf(*list, place);
        if (sums_.in(box) == 1) return; // the leaf itself
        forEachLeafIn(atlas_, box, [&](std::uint32_t other, const CellPlace& otherPlace) {
            const std::uint32_t* const otherList = &atlas_.references[leafList(other)];
            const std::optional<std::uint32_t> missing = firstMissing(list, otherList);
            if (!missing) return true;
            faults_.add([&] {
                return fmt::format("the exit box of {} holds {}, which lists triangle {}; {} does not",
                                   nameOf(place), nameOf(otherPlace), *missing, nameOf(place));
            });
            return false;
        });
    }
    // The first triangle of another list that is not in this one; both ascend.
    static std::optional<std::uint32_t> firstMissing(const std::uint32_t* own, const std::uint32_t* other) {
        own += kListHeaderWords;
        for (other += kListHeaderWords;; ++other) {
            const std::uint32_t wanted = *other & ~kLastInList;
            while ((*own & ~kLastInList) < wanted && !(*own & kLastInList)) ++own;
            if ((*own & ~kLastInList) != wanted) return wanted;
            if (*other & kLastInList) return std::nullopt;
        }
    }

    const Atlas& atlas_;
    const CellBlock& block_;
    const OccupancySums& sums_;
    Faults& faults_;
};

// All that the boxes of a brick reach.
CellBox reachOf(const Atlas& atlas, const CellBlock& brick) {
    CellBox reach{brick.first, brick.first + brick.dims - 1, brick.level};
    for (std::size_t i = 0; i < brick.words.size(); ++i) {
        const std::uint32_t word = brick.words[i];
        if (isBrick(word)) continue;
        const std::uint32_t boxWord = word & kOccupiedBit ? atlas.references[leafList(word)] : word;
        const CellBox box = freeBoxOf(boxWord, brick.place(i));
        reach.lo = glm::min(reach.lo, box.lo);
        reach.hi = glm::max(reach.hi, box.hi);
    }
    return reach;
}

LeapProof verifyGridBoxes(const Atlas& atlas, WorkMeter& meter) {
    const CellBlock grid = gridBlock(atlas);
    OccupancySums sums;
    sums.count(atlas, {glm::ivec3(0), grid.dims - 1, 0});
    std::atomic<std::uint64_t> boxes{0};
    LeapProof proof;
    proof.faults = findFaults(grid.words.size(), kVoxelsPerBlock, meter,
                              [&](std::size_t begin, std::size_t end, Faults& faults) {
                                  boxes += BoxProof(atlas, grid, sums, faults).check(begin, end);
                              });
    proof.leaps = boxes;
    return proof;
}

} // namespace

LeapProof verifyDistances(const Atlas& atlas, WorkMeter& meter) {
    const bool hasDistances = atlas.grid.dims.w == kStructureCloud;
    std::optional<DistanceProof> distances;
    if (hasDistances) distances.emplace(atlas);
    const CellBlock grid = gridBlock(atlas);
    std::atomic<std::uint32_t> largest{0};
    LeapProof proof;
    proof.faults = findFaults(
        grid.words.size(), kVoxelsPerBlock, meter, [&](std::size_t begin, std::size_t end, Faults& faults) {
            std::uint32_t largestHere = 0;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t word = grid.words[i];
                if (word & kOccupiedBit) {
                    if (atlas.references[leafList(word)] == 0) continue;
                    faults.add([&] { return fmt::format("{} has an exit box", nameOf(grid.place(i))); });
                } else {
                    largestHere = std::max(largestHere, word);
                    if (hasDistances) distances->check(grid.place(i), word, faults);
                }
            }
            for (std::uint32_t seen = largest;
                 seen < largestHere && !largest.compare_exchange_weak(seen, largestHere);) {
            }
        });
    if (largest != atlas.info.maxDistance)
        proof.faults.add([&] {
            return fmt::format("the largest distance is {}, but {} in INFO", largest.load(),
                               atlas.info.maxDistance);
        });
    proof.leaps = grid.words.size();
    return proof;
}

LeapProof verifyBoxes(const Atlas& atlas, WorkMeter& meter) {
    LeapProof proof = verifyGridBoxes(atlas, meter);
    const std::vector<BrickPlace> bricks = bricksOf(atlas, "atlas");
    tbb::enumerable_thread_specific<OccupancySums> sumsOfThreads;
    std::atomic<std::uint64_t> boxes{0};
    proof.faults.append(
        findFaults(bricks.size(), 16, meter, [&](std::size_t begin, std::size_t end, Faults& faults) {
            OccupancySums& sums = sumsOfThreads.local();
            for (std::size_t i = begin; i < end; ++i) {
                const CellBlock brick = brickBlock(atlas, bricks[i]);
                sums.count(atlas, reachOf(atlas, brick));
                boxes += BoxProof(atlas, brick, sums, faults).check(0, brick.words.size());
            }
        }));
    proof.leaps += boxes;
    return proof;
}

} // namespace rt
