#include "tools/rt-grid/fresh_array.h"

#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace rt {

std::shared_ptr<void> freshMemory(std::size_t bytes) {
    constexpr std::size_t kHugePage = std::size_t(1) << 21;
    const bool isLarge = bytes >= kHugePage;
    const std::size_t page = isLarge ? kHugePage : alignof(std::max_align_t);
    const std::size_t wholePages = (bytes + page - 1) / page * page;
    void* const memory = std::aligned_alloc(page, wholePages);
    if (!memory) throw std::bad_alloc();
    if (isLarge) madvise(memory, wholePages, MADV_HUGEPAGE); // only a wish
    return {memory, std::free};
}

} // namespace rt
