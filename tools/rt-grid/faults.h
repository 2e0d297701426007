#pragma once
#include "common/stage_timer.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace rt {

/// What a check found wrong: how often, and the first counter-examples.
struct Faults {
    static constexpr std::size_t kShown = 5;
    std::uint64_t count = 0;
    std::vector<std::string> first;

    /// `describe` is called where the fault is among the first.
    template <class Describe>
    void add(Describe&& describe) {
        if (first.size() < kShown) first.push_back(describe());
        ++count;
    }
    void append(const Faults& later);
};

/// Calls check(begin, end, faults), from several threads, for blocks of up to `blockSize` of the indices
/// below `count`. Returns the faults in the order of the indices, whatever the number of threads.
/// `meter` counts the blocks.
Faults findFaults(std::size_t count, std::size_t blockSize, WorkMeter& meter,
                  const std::function<void(std::size_t begin, std::size_t end, Faults& faults)>& check);

} // namespace rt
