#include "common/stage_timer.h"

#include "common/log.h"
#include "common/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sys/resource.h>

namespace rt {
namespace {

const auto programStart = std::chrono::steady_clock::now();

} // namespace

std::optional<double> WorkMeter::part() const {
    const auto total = static_cast<double>(total_);
    if (total == 0.0) return std::nullopt;
    return std::min(1.0, static_cast<double>(done_) / total);
}

void StageTimer::begin(std::string_view stage) {
    end();
    running_->meter.begin(0);
    const std::scoped_lock lock(running_->mutex);
    running_->name = stage;
    running_->start = Clock::now();
}

void StageTimer::end() {
    if (running_->name.empty()) return;
    add(running_->name, std::chrono::duration<double, std::milli>(Clock::now() - running_->start).count());
    const std::scoped_lock lock(running_->mutex);
    running_->name.clear();
}

std::string StageTimer::runningText() const {
    const std::scoped_lock lock(running_->mutex);
    if (running_->name.empty()) return "";
    const double seconds = std::chrono::duration<double>(Clock::now() - running_->start).count();
    const std::optional<double> part = running_->meter.part();
    return running_->name + (part ? fmt::format(" {:.0f} %", std::floor(100.0 * *part)) : "") + ", " +
           durationText(seconds);
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
