#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rt {

/// How much of some work is done: counted by the threads that do it, read by one that shows it.
class WorkMeter {
public:
    /// `total` units of work are to be done, none of which is.
    void begin(std::uint64_t total) {
        done_ = 0;
        total_ = total;
    }
    void add(std::uint64_t units = 1) { done_.fetch_add(units, std::memory_order_relaxed); }
    /// From 0 to 1; nothing where nobody counts.
    std::optional<double> part() const;

private:
    std::atomic<std::uint64_t> done_{0}, total_{0};
};

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
    /// Of the running stage.
    WorkMeter& meter() { return running_->meter; }
    /// "boxes 43 %, 12 s"; empty if no stage is running. For any thread.
    std::string runningText() const;

private:
    using Clock = std::chrono::steady_clock;
    struct Running {
        mutable std::mutex mutex; // of name and start
        std::string name;         // empty: none
        Clock::time_point start{};
        WorkMeter meter;
    };
    std::shared_ptr<Running> running_ = std::make_shared<Running>();
    std::vector<std::pair<std::string, double>> stagesMs_;
};

/// Milliseconds since this program's global objects were made, just before main() began.
double programMs();

/// Logs each stage's time, and the memory taken, as details (-v).
void logStages(const StageTimer& timer);

/// Largest resident set of this process so far, in bytes.
std::uint64_t peakMemoryBytes();

} // namespace rt
