#pragma once
#include "common/binary_io.h"

#include <cstdlib>
#include <memory>
#include <new>
#include <sys/mman.h>

namespace rt {

/// Values in memory that nobody has written before: filling it from several threads is what costs. Kept by
/// all copies together.
template <class T>
class FreshArray : public std::span<T> {
public:
    explicit FreshArray(std::size_t count = 0) : FreshArray(count, allocate(count)) {}
    SharedSpan<T> share() const { return {*this, owner_}; }

private:
    static constexpr std::size_t kHugePage = std::size_t(1) << 21; // bytes

    FreshArray(std::size_t count, std::shared_ptr<T[]> owner)
        : std::span<T>(owner.get(), count), owner_(std::move(owner)) {}
    static std::shared_ptr<T[]> allocate(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        if (count == 0) return {};
        const std::size_t page = count * sizeof(T) < kHugePage ? alignof(std::max_align_t) : kHugePage;
        const std::size_t bytes = (count * sizeof(T) + page - 1) / page * page;
        void* const memory = std::aligned_alloc(page, bytes);
        if (!memory) throw std::bad_alloc();
        if (page == kHugePage) madvise(memory, bytes, MADV_HUGEPAGE); // only a wish: fewer page faults
        return std::shared_ptr<T[]>(static_cast<T*>(memory), std::free);
    }

    std::shared_ptr<T[]> owner_;
};

} // namespace rt
