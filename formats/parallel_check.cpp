#include "formats/parallel_check.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <future>

namespace rt {

void checkTogether(const std::vector<std::function<void()>>& checks) {
    std::vector<std::packaged_task<void()>> tasks; // they keep what is thrown: TBB would cancel the others
    for (const auto& check : checks) tasks.emplace_back(check);
    tbb::parallel_for(std::size_t(0), tasks.size(), [&](std::size_t i) { tasks[i](); });
    for (auto& task : tasks) task.get_future().get();
}

std::size_t firstFault(std::size_t count, std::size_t blockSize,
                       const std::function<std::size_t(std::size_t, std::size_t)>& firstIn) {
    std::atomic<std::size_t> lowest{count};
    const std::size_t blocks = count / blockSize + (count % blockSize != 0);
    tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
        const std::size_t begin = block * blockSize;
        std::size_t seen = lowest;
        if (begin >= seen) return; // a later block has nothing to add
        const std::size_t end = begin + std::min(blockSize, count - begin);
        const std::size_t fault = firstIn(begin, end);
        while (fault < end && fault < seen && !lowest.compare_exchange_weak(seen, fault)) {
        }
    });
    return lowest;
}

} // namespace rt
