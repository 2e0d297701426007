#pragma once
#include <chrono>
#include <string>

namespace rt {

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

/// "43 %, 12.5 M samples/s, 1 min 20 s left", without the rate if the unit has no name. `rate` in units per
/// second, 0 if it is not known.
std::string progressText(const std::string& unit, double done, double total, double rate);

/// "850 ms", "12 s", "1 min 20 s", "3 h 05 min".
std::string durationText(double seconds);

} // namespace rt
