#include "tools/rt-grid/leaf_relations.h"

#include "tools/rt-grid/lanes.h"
#include "tools/rt-grid/triangle_lists.h"

namespace rt {

bool LeafRelations::holdsAll(const Set& whole, const Set& part) {
    std::uint64_t missing = 0;
    for (std::size_t i = 0; i < kSetWords; ++i) missing |= part[i] & ~whole[i];
    return missing == 0;
}

template <int kAxis>
void LeafRelations::nameStepsAlong(std::span<const std::uint32_t> words, int shift, std::uint32_t voxel,
                                   std::uint32_t* references) const {
    const std::uint32_t last = (1u << shift) - 1;
    const std::uint32_t next = voxel + (1u << (kAxis * shift));
    if ((voxel >> (kAxis * shift) & last) == last || words[next] == 0 || isBrick(words[next])) return;
    std::uint32_t& list = references[leafList(words[voxel])];
    std::uint32_t& nextList = references[leafList(words[next])];
    const auto listsAll = [&](std::uint32_t whole, std::uint32_t part, const std::uint32_t& a,
                              const std::uint32_t& b) {
        return holdsAll(sets_[whole], sets_[part]) && (isExact_ || isSubset(ListReader(&b), ListReader(&a)));
    };
    list |= std::uint32_t(listsAll(voxel, next, list, nextList)) << (2 * kAxis + 1);
    nextList |= std::uint32_t(listsAll(next, voxel, nextList, list)) << (2 * kAxis);
}

RT_WIDE_LANES void LeafRelations::nameSteps(std::span<const std::uint32_t> words, int shift,
                                            std::span<const std::uint32_t> leaves,
                                            std::uint32_t* references) const {
    for (const std::uint32_t voxel : leaves) {
        nameStepsAlong<0>(words, shift, voxel, references);
        nameStepsAlong<1>(words, shift, voxel, references);
        nameStepsAlong<2>(words, shift, voxel, references);
    }
}

} // namespace rt
