#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rt {

/// Milliseconds of each named stage, in the order in which they first ran; a stage may run several times.
class StageTimer {
public:
    /// Ends the running stage, if any, and starts the next one.
    void begin(std::string_view stage);
    void end();
    /// Adds a time that was taken elsewhere.
    void add(std::string_view stage, double ms);
    const std::vector<std::pair<std::string, double>>& stagesMs() const { return stagesMs_; }
    double totalMs() const;

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_{};
    std::string running_; // empty: none
    std::vector<std::pair<std::string, double>> stagesMs_;
};

/// Milliseconds since this program's global objects were made, just before main() began.
double programMs();

/// Logs each stage's time, and the memory taken, as details (-v).
void logStages(const StageTimer& timer);

/// Largest resident set of this process so far, in bytes.
std::uint64_t peakMemoryBytes();

} // namespace rt
