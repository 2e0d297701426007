#pragma once
#include "formats/atlas.h"

#include <map>
#include <vector>

namespace rt {

/// How often each number came.
class Histogram {
public:
    void add(std::size_t value, std::uint64_t times = 1);
    std::uint64_t count() const { return count_; }
    double mean() const {
        return count_ == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(count_);
    }
    std::size_t largest() const { return counts_.empty() ? 0 : counts_.size() - 1; }
    /// Of each value from 0 to largest().
    const std::vector<std::uint64_t>& counts() const { return counts_; }

private:
    std::vector<std::uint64_t> counts_;
    std::uint64_t count_ = 0, sum_ = 0;
};

/// All voxels of one size.
struct LevelFigures {
    std::map<int, std::uint64_t> bricks; ///< by the voxels along their side; the grid is none
    std::uint64_t empty = 0;
    std::uint64_t leaves = 0;
    std::uint64_t crowded = 0; ///< that hold a brick
    std::uint64_t references = 0;

    std::uint64_t voxels() const { return empty + leaves + crowded; }
};

/// What is in an atlas.
struct AtlasFigures {
    std::vector<LevelFigures> levels; ///< by level; those without voxels too
    Histogram distances;              ///< of empty voxels: leapDistance()
    Histogram extents;                ///< of empty voxels' boxes: voxels beyond this one on each of six sides
    Histogram exits;                  ///< the same of leaves' exit boxes
    Histogram referencesPerLeaf;
    Histogram referencesPerTriangle;
    double occupiedVolume = 0.0; ///< share of the grid's volume that is in leaves
};

/// The atlas must have passed validate().
AtlasFigures figuresOf(const Atlas& atlas);

} // namespace rt
