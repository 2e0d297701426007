#include "tools/rt-trace/warm_up.h"

#include "common/stage_timer.h"

namespace rt {
namespace {

// GPUs idle at a fraction of their clock; this long is enough to reach it, as far as measured.
constexpr double kWarmUpMs = 1200.0;

} // namespace

void warmUp(const std::function<void()>& pass) {
    const double endMs = programMs() + kWarmUpMs;
    do pass();
    while (programMs() < endMs);
}

double medianOf(std::span<const double> sorted) {
    const std::size_t half = sorted.size() / 2;
    return sorted.size() % 2 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

} // namespace rt
