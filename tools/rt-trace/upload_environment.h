#pragma once
#include "tools/rt-trace/environment.h"
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gl_objects.h"

namespace rt {

/// An environment in the device's memory, as shaders/environment.glsl reads it.
class GpuEnvironment {
public:
    /// Throws Error{LimitExceeded}, message prefixed by `name`, if the device cannot hold it.
    GpuEnvironment(const EnvironmentMap& map, const GlLimits& limits, const std::string& name);
    static std::uint64_t bytesFor(const EnvironmentMap& map);
    void bind() const;

private:
    GlTexture texture_;
    GlBuffer table_;
};

} // namespace rt
