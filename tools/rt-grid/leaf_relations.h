#pragma once
#include "formats/atlas.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rt {

/// Which leaves of a brick list nothing that the leaf beside them does not list as well: there exit boxes may
/// go on. Sets of a brick's triangles are bits by their position in the brick's list.
class LeafRelations {
public:
    /// Of a brick with `voxels` voxels and `triangles` triangles.
    void begin(std::size_t voxels, std::size_t triangles) {
        isExact_ = triangles <= 64 * kSetWords;
        sets_.assign(voxels, Set{});
    }
    void add(std::uint32_t voxel, std::size_t position) {
        sets_[voxel][position / 64 % kSetWords] |= std::uint64_t(1) << (position & 63);
    }
    /// Sets bit i of the header of each leaf's list if a box may step over the leaf's face i into another
    /// leaf of the brick. Faces: x down, x up, y down, ... `words` are the brick's, `leaves` indices of its
    /// leaves.
    void nameSteps(std::span<const std::uint32_t> words, int shift, std::span<const std::uint32_t> leaves,
                   std::uint32_t* references) const;

private:
    static constexpr std::size_t kSetWords = 4;
    using Set = std::array<std::uint64_t, kSetWords>;
    template <int kAxis>
    void nameStepsAlong(std::span<const std::uint32_t> words, int shift, std::uint32_t voxel,
                        std::uint32_t* references) const;
    static bool holdsAll(const Set& whole, const Set& part);

    std::vector<Set> sets_; // of each voxel
    bool isExact_ = true;   // otherwise several triangles share a bit
};

} // namespace rt
