#pragma once
#include "tools/rt-trace/gl_objects.h"

#include <chrono>

namespace rt {

/// Measures the GL commands between begin() and end(). On hardware by a timer query, without waiting, so that
/// several may follow each other while the device is kept busy; a device that has to wait for the host counts
/// that too. Software renderers give timer queries no meaning: there it is the host's clock between two
/// glFinish().
class GpuTimer {
public:
    explicit GpuTimer(bool software);
    void begin();
    void end();
    /// Waits for the commands to finish; returns milliseconds.
    double elapsedMs() const;

private:
    using Clock = std::chrono::steady_clock;
    bool software_;
    GlQuery query_;
    Clock::time_point start_{}, end_{};
};

} // namespace rt
