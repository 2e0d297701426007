#include "tools/rt-grid/grow_exits.h"

#include "formats/atlas.shared.h"

#include <bit>

namespace rt {
namespace {

// Reads the triangles of a list, ascending.
class ListReader {
public:
    explicit ListReader(const std::uint32_t* list) : next_(list + kListHeaderWords) {}
    bool read(std::uint32_t& triangle) {
        if (!next_) return false;
        const std::uint32_t entry = *next_;
        next_ = entry & kLastInList ? nullptr : next_ + 1;
        triangle = entry & ~kLastInList;
        return true;
    }

private:
    const std::uint32_t* next_; // none after the last
};

std::uint64_t signatureOf(ListReader list) {
    std::uint64_t signature = 0;
    for (std::uint32_t triangle = 0; list.read(triangle);) signature |= std::uint64_t(1) << (triangle & 63);
    return signature;
}

bool isSubset(ListReader part, ListReader whole) {
    std::uint32_t wanted = 0;
    std::uint32_t found = 0;
    while (part.read(wanted)) {
        do
            if (!whole.read(found)) return false;
        while (found < wanted);
        if (found != wanted) return false;
    }
    return true;
}

} // namespace

ExitGrower::ExitGrower(const OccupancyWindow& window, const VoxelBlock& block, std::uint32_t* references,
                       int reach)
    : window_(window), block_(block), references_(references), reach_(reach) {
    if (reach == 0) return;
    const glm::ivec3& size = block.size;
    const std::uint64_t columns = ~std::uint64_t(0) >> (64 - size.x);
    signatures_.resize(static_cast<std::size_t>(size.x * size.y * size.z));
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y) {
            std::uint64_t bits = window.row(y + block.first.y, z + block.first.z) >> block.first.x & columns;
            for (; bits != 0; bits &= bits - 1) {
                const glm::ivec3 voxel(std::countr_zero(bits), y, z);
                const std::uint32_t word = *block.word(voxel);
                signatures_[indexOf(voxel)] =
                    isBrick(word) ? ~std::uint64_t(0) : signatureOf(ListReader(references + leafList(word)));
            }
        }
}

void ExitGrower::grow(const glm::ivec3& voxel) {
    if (reach_ == 0) return;
    std::uint32_t* const list = references_ + leafList(*block_.word(voxel - block_.first));
    list_ = list;
    signature_ = signatures_[indexOf(voxel - block_.first)];
    lo_ = hi_ = voxel;
    std::array<bool, 6> grows{true, true, true, true, true, true};
    for (int i = 0; i < reach_; ++i) {
        grows[0] = grows[0] && tryFace<0, false>();
        grows[1] = grows[1] && tryFace<0, true>();
        grows[2] = grows[2] && tryFace<1, false>();
        grows[3] = grows[3] && tryFace<1, true>();
        grows[4] = grows[4] && tryFace<2, false>();
        grows[5] = grows[5] && tryFace<2, true>();
    }
    list[0] = freeBoxWord(voxel - lo_, hi_ - voxel);
}

// Moves the face by one voxel if the box may cover all voxels in front of it.
template <int kAxis, bool kUp>
bool ExitGrower::tryFace() {
    const int front = kUp ? hi_[kAxis] + 1 : lo_[kAxis] - 1;
    glm::ivec3 lo = lo_;
    glm::ivec3 hi = hi_;
    lo[kAxis] = hi[kAxis] = front;
    const std::uint64_t columns = (~std::uint64_t(0) >> (63 - (hi.x - lo.x))) << lo.x;
    for (int z = lo.z; z <= hi.z; ++z)
        for (int y = lo.y; y <= hi.y; ++y)
            for (std::uint64_t bits = window_.row(y, z) & columns; bits != 0; bits &= bits - 1)
                if (!mayCover({std::countr_zero(bits), y, z})) return false;
    (kUp ? hi_ : lo_)[kAxis] = front;
    return true;
}

// The voxel is occupied.
bool ExitGrower::mayCover(const glm::ivec3& voxel) const {
    const glm::ivec3 at = voxel - block_.first;
    if (!block_.holds(at) || (signatures_[indexOf(at)] & ~signature_) != 0) return false;
    const std::uint32_t word = *block_.word(at);
    return !isBrick(word) && isSubset(ListReader(references_ + leafList(word)), ListReader(list_));
}

} // namespace rt
