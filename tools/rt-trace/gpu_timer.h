#pragma once
#include "tools/rt-trace/gl_objects.h"

#include <chrono>

namespace rt {

/// Measures the GL commands between begin() and endMs(). On hardware by a timer query; software renderers
/// give those no meaning, so there it is the host's clock between two glFinish().
class GpuTimer {
public:
    explicit GpuTimer(bool software);
    void begin();
    /// Waits for the commands to finish; returns milliseconds.
    double endMs();

private:
    bool software_;
    GlQuery query_;
    std::chrono::steady_clock::time_point start_{};
};

} // namespace rt
