#include "tools/rt-grid/leaf_relations.h"

#include "tools/rt-grid/triangle_lists.h"

namespace rt {

bool LeafRelations::holdsAll(const Set& whole, const Set& part) {
    std::uint64_t missing = 0;
    for (std::size_t i = 0; i < kSetWords; ++i) missing |= part[i] & ~whole[i];
    return missing == 0;
}

void LeafRelations::nameSteps(std::span<const std::uint32_t> words, int shift,
                              std::span<const std::uint32_t> leaves, std::uint32_t* references) const {
    const auto listsAll = [&](std::uint32_t whole, std::uint32_t part) {
        return holdsAll(sets_[whole], sets_[part]) &&
               (isExact_ || isSubset(ListReader(references + leafList(words[part])),
                                     ListReader(references + leafList(words[whole]))));
    };
    const std::uint32_t last = (1u << shift) - 1;
    for (const std::uint32_t voxel : leaves)
        for (int axis = 0; axis < 3; ++axis) {
            if ((voxel >> (axis * shift) & last) == last) continue;
            const std::uint32_t next = voxel + (1u << (axis * shift));
            if (words[next] == 0 || isBrick(words[next])) continue;
            references[leafList(words[voxel])] |= std::uint32_t(listsAll(voxel, next)) << (2 * axis + 1);
            references[leafList(words[next])] |= std::uint32_t(listsAll(next, voxel)) << (2 * axis);
        }
}

} // namespace rt
