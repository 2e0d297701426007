#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rt {

/// Milliseconds of each named stage, in the order in which they ran.
class StageTimer {
public:
    /// Ends the running stage, if any, and starts the next one.
    void begin(std::string_view stage);
    void end();
    const std::vector<std::pair<std::string, double>>& stagesMs() const { return stagesMs_; }
    double totalMs() const;

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_{};
    bool running_ = false;
    std::vector<std::pair<std::string, double>> stagesMs_;
};

/// Logs each stage's time, and the memory taken, as details (-v).
void logStages(const StageTimer& timer);

/// Largest resident set of this process so far, in bytes.
std::uint64_t peakMemoryBytes();

} // namespace rt
