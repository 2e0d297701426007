#include "common/stage_timer.h"

#include "common/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <sys/resource.h>

namespace rt {
namespace {

const auto programStart = std::chrono::steady_clock::now();

} // namespace

void StageTimer::begin(std::string_view stage) {
    end();
    running_ = stage;
    start_ = Clock::now();
}

void StageTimer::end() {
    if (running_.empty()) return;
    add(running_, std::chrono::duration<double, std::milli>(Clock::now() - start_).count());
    running_.clear();
}

void StageTimer::add(std::string_view stage, double ms) {
    const auto known = std::find_if(stagesMs_.begin(), stagesMs_.end(),
                                    [&](const auto& entry) { return entry.first == stage; });
    if (known == stagesMs_.end())
        stagesMs_.emplace_back(stage, ms);
    else
        known->second += ms;
}

double StageTimer::totalMs() const {
    double total = 0.0;
    for (const auto& [stage, ms] : stagesMs_) total += ms;
    return total;
}

double programMs() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - programStart).count();
}

void logStages(const StageTimer& timer) {
    for (const auto& [stage, ms] : timer.stagesMs()) logDetail(fmt::format("{:<14}{:9.1f} ms", stage, ms));
    logDetail(fmt::format("largest memory {} MiB", peakMemoryBytes() >> 20));
}

std::uint64_t peakMemoryBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u; // Linux counts in KiB
}

} // namespace rt
