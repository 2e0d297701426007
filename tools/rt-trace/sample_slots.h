#pragma once
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/slot_layout.h"

#include <cstdint>

namespace rt {

/// Room on the device for the samples of a batch, and the rounds that trace one ray of each.
class SampleSlots {
public:
    SampleSlots(const SceneFeatures& features, const GlLimits& limits);
    void bind() const;
    /// Samples that there is room for.
    unsigned count() const { return count_; }
    /// Renders a batch of so many, with the program and parameters that are current.
    void render(unsigned samples);

private:
    unsigned count_;
    unsigned rounds_ = 2; // that the last batch took
    GlBuffer slots_, queue_;
};

} // namespace rt
