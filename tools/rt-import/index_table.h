#pragma once
#include <bit>
#include <cstdint>
#include <vector>

namespace rt {

/// Hash table of indices into an array kept elsewhere, of which at most `maxCount` will be inserted: no node
/// or key is stored, so a million entries take 8 MB.
class IndexTable {
public:
    explicit IndexTable(std::size_t maxCount)
        : slots_(std::bit_ceil(maxCount * 2 + 2), kFree), mask_(slots_.size() - 1) {}

    /// The stored index for which equal(index) holds, or else `candidate`, which is stored then.
    template <class Equal>
    std::uint32_t findOrInsert(std::uint64_t hash, std::uint32_t candidate, Equal equal) {
        for (std::size_t slot = hash & mask_;; slot = (slot + 1) & mask_) {
            if (slots_[slot] == kFree) return slots_[slot] = candidate;
            if (equal(slots_[slot])) return slots_[slot];
        }
    }

private:
    static constexpr std::uint32_t kFree = 0xFFFFFFFFu;
    std::vector<std::uint32_t> slots_;
    std::size_t mask_;
};

/// Mixes one more word into a hash (the finalizer of MurmurHash3, Appleby 2011).
inline std::uint64_t mixHash(std::uint64_t hash, std::uint32_t word) {
    hash ^= word;
    hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccdull;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53ull;
    return hash ^ (hash >> 33);
}

/// The bits of a number, the same for -0 and +0, which compare equal.
inline std::uint32_t hashBits(float value) {
    return std::bit_cast<std::uint32_t>(value + 0.0f);
}

} // namespace rt
