#pragma once
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/slot_layout.h"

#include <cstdint>
#include <functional>

namespace rt {

/// Milliseconds on the host's clock that the device takes for the parts of its work.
struct StageTimes {
    double traceMs = 0.0;
    double intersectMs = 0.0; ///< of RayPasses, whose traceMs is without it
    double shadeMs = 0.0;
    double resolveMs = 0.0;
};

/// What `work` gives the device to do. The device is awaited before and after it, and its time added to `ms`,
/// if anybody wants to know.
void timed(double* ms, const std::function<void()>& work);

/// Room on the device for the samples of a batch.
class SampleSlots {
public:
    static constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 31;

    /// As many slots as the device has room for, but not more than `most`.
    SampleSlots(const SceneFeatures& features, const GlLimits& limits, std::uint64_t most);
    /// What that takes of the device's memory, with SampleRounds if the features have them.
    static std::uint64_t bytesFor(const SceneFeatures& features, const GlLimits& limits, std::uint64_t most);
    void bind() const;
    /// Samples that there is room for.
    unsigned count() const { return count_; }

private:
    unsigned count_;
    GlBuffer slots_;
};

/// The rounds that trace one ray of each sample, and the queues of those that have one. RayPasses has none.
class SampleRounds {
public:
    /// For so many slots.
    explicit SampleRounds(unsigned slots);
    void bind() const;
    /// Renders a batch of so many, with the parameters that are bound. With `times` the device is awaited
    /// after each part, whose time is added.
    void render(const GpuPrograms& programs, unsigned samples, StageTimes* times);

private:
    bool isWanted(unsigned round);

    unsigned expected_ = 2; // as the last batch took
    GlBuffer rounds_;
    GlBuffer noRounds_; // a group's before it begins
    GlBuffer answer_;   // a round; what the host reads must not be what shaders write, or drivers move it to
                        // the host
};

} // namespace rt
