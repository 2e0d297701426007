#pragma once
#include <chrono>
#include <memory>
#include <string>

namespace rt {

class StageTimer;

/// A line on the terminal that says how far some work is: part done, rate and time left. Nothing appears
/// where standard error is no terminal, where NO_COLOR is set or the log is quiet, nor in the first second.
class Progress {
public:
    /// `total` units of work named `unit`, of which `done` are done.
    Progress(std::string unit, double total, double done = 0.0);
    ~Progress(); ///< clears the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void update(double done);
    /// Takes the line away, so that something else can be printed.
    void clear();

private:
    using Clock = std::chrono::steady_clock;
    std::string unit_;
    double total_, first_;
    Clock::time_point start_, last_;
    bool visible_, drawn_ = false;
};

/// A line on the terminal that says which stage is running, for how long and how far it is, as long as the
/// object lives; it appears where and when Progress does. It has a thread of its own.
class StageProgress {
public:
    explicit StageProgress(const StageTimer& timer); ///< which must outlive the object
    ~StageProgress();                                ///< clears the line
    StageProgress(const StageProgress&) = delete;
    StageProgress& operator=(const StageProgress&) = delete;

private:
    class Thread;
    std::unique_ptr<Thread> thread_; // none where nothing appears
};

/// "43 %, 12.5 M samples/s, 1 min 20 s left", without the rate if the unit has no name. `rate` in units per
/// second, 0 if it is not known.
std::string progressText(const std::string& unit, double done, double total, double rate);

/// "850 ms", "12 s", "1 min 20 s", "3 h 05 min".
std::string durationText(double seconds);

} // namespace rt
