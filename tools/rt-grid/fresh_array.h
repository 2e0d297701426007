#pragma once
#include "common/binary_io.h"

#include <memory>

namespace rt {

/// Memory that nobody has written before, in large pages where the system has them. Throws std::bad_alloc.
std::shared_ptr<void> freshMemory(std::size_t bytes);

/// An array in such memory, for values that are all written anyway: clearing them first on one core would
/// cost as much as computing them on several. Kept by all its copies together.
template <class T>
class FreshArray : public std::span<T> {
public:
    explicit FreshArray(std::size_t count = 0)
        : FreshArray(count, count == 0 ? nullptr : freshMemory(count * sizeof(T))) {}
    SharedSpan<T> share() const { return {*this, memory_}; }

private:
    static_assert(std::is_trivially_copyable_v<T>);
    FreshArray(std::size_t count, std::shared_ptr<void> memory)
        : std::span<T>(static_cast<T*>(memory.get()), count), memory_(std::move(memory)) {}

    std::shared_ptr<void> memory_;
};

} // namespace rt
