#include "tools/rt-grid/verify_lists.h"

#include "tools/rt-grid/atlas_cells.h"
#include "tools/rt-grid/clip_triangle.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace rt {
namespace {

// Of the pad: what rounding in double may hide. Coordinates are below 2^19 voxels and off by some 2^-50 of
// that, and the pad is 2^-20 of it or more.
constexpr double kSlack = 0x1p-20;

// Tells whether a list holds a triangle, in few steps for long lists too.
class ListIndex {
public:
    explicit ListIndex(std::span<const std::uint32_t> references) : references_(references) {
        for (std::size_t first = 0; first < references.size();) {
            std::size_t last = first + kListHeaderWords;
            while (!(references[last] & kLastInList)) ++last;
            if (last - first > kShort) longLists_.push_back({first, last});
            first = last + 1;
        }
    }
    bool holds(std::size_t list, std::uint32_t triangle) const {
        for (std::size_t i = list + kListHeaderWords; i <= list + kShort; ++i) {
            const std::uint32_t entry = references_[i] & ~kLastInList;
            if (entry >= triangle) return entry == triangle;
            if (references_[i] & kLastInList) return false;
        }
        const auto found = std::lower_bound(longLists_.begin(), longLists_.end(), list,
                                            [](const List& a, std::size_t first) { return a.first < first; });
        const auto* const begin = references_.data() + list + kShort;
        const auto* const last = references_.data() + found->last; // marked, so larger than it is
        return (*last & ~kLastInList) == triangle || std::binary_search(begin, last, triangle);
    }

private:
    static constexpr std::size_t kShort = 32;
    struct List {
        std::size_t first, last;
    };
    std::span<const std::uint32_t> references_;
    std::vector<List> longLists_;
};

// Looks one triangle up in all voxels that it comes near.
class TriangleProof {
public:
    TriangleProof(const Atlas& atlas, const ListIndex& lists, std::uint32_t triangle, Faults& faults)
        : atlas_(atlas), lists_(lists), triangle_(triangle), faults_(faults) {
        const glm::dvec3 lo(atlas.grid.gridLo), size(atlas.grid.cellSize);
        const TriangleRecord& t = atlas.triangles[triangle];
        for (int i = 0; i < 3; ++i)
            corners_[i] = (glm::dvec3(i == 0 ? t.v0 : i == 1 ? t.v1 : t.v2) - lo) / size;
    }
    std::uint64_t run() {
        requireInside();
        visit(gridBlock(atlas_));
        return needed_;
    }

private:
    void requireInside() {
        const double margin = 12.0 * 0x1p-24 * longestSide();
        for (const glm::dvec3& corner : corners_)
            for (int axis = 0; axis < 3; ++axis)
                if (corner[axis] < margin || corner[axis] > atlas_.grid.dims[axis] - margin)
                    return faults_.add([&] {
                        return fmt::format("triangle {} lies outside the grid, or too near to its border",
                                           triangle_);
                    });
    }
    double longestSide() const {
        const glm::uvec4& dims = atlas_.grid.dims;
        return std::max({dims.x, dims.y, dims.z});
    }

    // Voxels whose cubes, grown by the pad, hold a coordinate between two others.
    struct Indices {
        int lo, hi;
    };
    Indices near(const std::pair<double, double>& extent, int count, double pad) const {
        const double lo = std::ceil(extent.first - 1.0 - pad), hi = std::floor(extent.second + pad);
        return {static_cast<int>(std::clamp(lo, 0.0, double(count))),
                static_cast<int>(std::clamp(hi, -1.0, double(count - 1)))};
    }

    void visit(const CellBlock& block) {
        const double pad = promisedPad(atlas_, block.level) * (1.0 - kSlack);
        const double scale = std::ldexp(1.0, block.level);
        const glm::dvec3 first(block.first);
        const ClippedTriangle whole(corners_[0] * scale - first, corners_[1] * scale - first,
                                    corners_[2] * scale - first);
        const Indices xs = near(whole.extentAlong(0), block.dims.x, pad);
        for (int x = xs.lo; x <= xs.hi; ++x) {
            const ClippedTriangle slab = whole.between(0, x - pad, x + 1 + pad);
            if (slab.empty()) continue;
            const Indices ys = near(slab.extentAlong(1), block.dims.y, pad);
            for (int y = ys.lo; y <= ys.hi; ++y) {
                const ClippedTriangle column = slab.between(1, y - pad, y + 1 + pad);
                if (column.empty()) continue;
                const Indices zs = near(column.extentAlong(2), block.dims.z, pad);
                for (int z = zs.lo; z <= zs.hi; ++z) lookUp(block, block.first + glm::ivec3(x, y, z));
            }
        }
    }
    void lookUp(const CellBlock& block, const glm::ivec3& at) {
        const std::uint32_t word = block.word(at);
        const CellPlace place{at, block.level};
        if (isBrick(word)) return visit(brickBlock(atlas_, word, place));
        ++needed_;
        if (!(word & kOccupiedBit))
            faults_.add([&] {
                return fmt::format("triangle {} meets {}, which is empty", triangle_, nameOf(place));
            });
        else if (!lists_.holds(leafList(word), triangle_))
            faults_.add([&] {
                return fmt::format("triangle {} meets {}, which does not list it", triangle_, nameOf(place));
            });
    }

    const Atlas& atlas_;
    const ListIndex& lists_;
    std::uint32_t triangle_;
    Faults& faults_;
    glm::dvec3 corners_[3]; // in voxels of the grid
    std::uint64_t needed_ = 0;
};

std::uint64_t countListEnds(std::span<const std::uint32_t> references) {
    return static_cast<std::uint64_t>(
        std::count_if(references.begin(), references.end(), [](std::uint32_t w) { return w & kLastInList; }));
}

std::uint64_t countLeaves(std::span<const std::uint32_t> words) {
    return static_cast<std::uint64_t>(std::count_if(
        words.begin(), words.end(), [](std::uint32_t w) { return (w & kOccupiedBit) && !isBrick(w); }));
}

void requireCount(Faults& faults, const char* what, std::uint64_t found, const char* where,
                  std::uint64_t said) {
    if (found != said) faults.add([&] { return fmt::format("{} {}, but {} {}", found, what, said, where); });
}

} // namespace

double promisedPad(const Atlas& atlas, int level) {
    const glm::uvec4& dims = atlas.grid.dims;
    const double longest = std::ldexp(std::max({dims.x, dims.y, dims.z}), level); // in voxels of the level
    return std::max(0x1p-8, 0x1p-20 * longest);
}

ListProof verifyLists(const Atlas& atlas, WorkMeter& meter) {
    const ListIndex lists(atlas.references);
    std::atomic<std::uint64_t> needed{0};
    ListProof proof;
    proof.faults = findFaults(
        atlas.triangles.size(), 256, meter, [&](std::size_t begin, std::size_t end, Faults& faults) {
            std::uint64_t sum = 0;
            for (std::size_t i = begin; i < end; ++i)
                sum += TriangleProof(atlas, lists, static_cast<std::uint32_t>(i), faults).run();
            needed += sum;
        });
    proof.needed = needed;
    proof.held = atlas.references.size() - kListHeaderWords * countListEnds(atlas.references);
    return proof;
}

Faults verifyCounts(const Atlas& atlas) {
    Faults faults;
    const std::uint64_t lists = countListEnds(atlas.references);
    const std::uint64_t leaves = countLeaves(atlas.voxels) + countLeaves(atlas.bricks);
    requireCount(faults, "leaves", leaves, "lists", lists);
    requireCount(faults, "leaves", leaves, "occupied voxels in INFO", atlas.info.occupiedVoxels);
    requireCount(faults, "references", atlas.references.size() - kListHeaderWords * lists, "in INFO",
                 atlas.info.references);
    if (atlas.info.padCells < promisedPad(atlas, 0))
        faults.add([&] {
            return fmt::format("a pad of {} voxels in INFO, but {} are promised", atlas.info.padCells,
                               promisedPad(atlas, 0));
        });
    std::uint32_t before = kLastInList; // the entry before in the list, or none
    for (std::size_t i = 0; i < atlas.references.size(); ++i) {
        if (before & kLastInList) i += kListHeaderWords;
        const std::uint32_t entry = atlas.references[i];
        if (!(before & kLastInList) && (entry & ~kLastInList) <= before)
            faults.add([&] {
                return fmt::format("triangle {} does not ascend in its list, at word {} of REFS",
                                   entry & ~kLastInList, i);
            });
        before = entry;
    }
    return faults;
}

} // namespace rt
