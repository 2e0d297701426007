#include "common/stage_timer.h"

#include "common/log.h"

#include <fmt/format.h>

#include <sys/resource.h>

namespace rt {

void StageTimer::begin(std::string_view stage) {
    end();
    stagesMs_.emplace_back(stage, 0.0);
    start_ = Clock::now();
    running_ = true;
}

void StageTimer::end() {
    if (!running_) return;
    stagesMs_.back().second = std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    running_ = false;
}

double StageTimer::totalMs() const {
    double total = 0.0;
    for (const auto& [stage, ms] : stagesMs_) total += ms;
    return total;
}

void logStages(const StageTimer& timer) {
    for (const auto& [stage, ms] : timer.stagesMs()) logDetail(fmt::format("{:<10}{:9.1f} ms", stage, ms));
    logDetail(fmt::format("largest memory {} MiB", peakMemoryBytes() >> 20));
}

std::uint64_t peakMemoryBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u; // Linux counts in KiB
}

} // namespace rt
