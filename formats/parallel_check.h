#pragma once
#include "common/error.h"

#include <cstddef>
#include <functional>
#include <future>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rt {

/// Runs independent checks on all cores, each to its end. Where several throw, what the first of them in this
/// order has thrown comes out, whatever the number of threads.
void checkTogether(const std::vector<std::function<void()>>& checks);

/// Runs `work` on this thread while `check` runs on one of its own, or after it where `threads` is 1; each to
/// its end. Returns what `work` does. Where both throw, what `check` has thrown comes out.
template <class Work>
auto whileChecking(const std::function<void()>& check, int threads, Work&& work) {
    std::packaged_task<decltype(work())()> task(std::forward<Work>(work));
    std::future<void> checked = std::async(threads == 1 ? std::launch::deferred : std::launch::async, check);
    task();
    checked.get();
    return task.get_future().get();
}

/// The lowest index below `count` that is at fault, or `count`. `firstIn(begin, end)` returns the lowest one
/// of [begin, end), or `end`; it is called from several threads, for up to `blockSize` indices at a time, and
/// must not throw.
std::size_t firstFault(std::size_t count, std::size_t blockSize,
                       const std::function<std::size_t(std::size_t begin, std::size_t end)>& firstIn);

/// Throws Error{InvalidContent} "`name`: `what` i is invalid" for the lowest i for whose value `holds`,
/// called from several threads, is false.
template <class T, class Predicate>
void requireEach(std::span<const T> values, const std::string& name, const char* what,
                 const Predicate& holds) {
    constexpr std::size_t kBlockSize = 1u << 15; // tens of microseconds
    const std::size_t fault = firstFault(values.size(), kBlockSize, [&](std::size_t begin, std::size_t end) {
        const auto copy = holds; // what it captured can stay in registers
        while (begin < end && copy(values[begin])) ++begin;
        return begin;
    });
    if (fault < values.size())
        throw Error(ErrorKind::InvalidContent,
                    name + ": " + what + " " + std::to_string(fault) + " is invalid");
}

} // namespace rt
