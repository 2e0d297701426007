#pragma once
#include "tools/rt-trace/device_choice.h"
#include "tools/rt-trace/gl_limits.h"
#include "tools/rt-trace/gpu_memory.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What --list-devices says of a device.
struct GlDevice {
    unsigned index = 0;
    bool software = false;
    std::optional<unsigned> cuda; ///< see cudaNumber()
    std::string renderer;
    std::string version;
    std::string driver;
    GpuMemory memory;
    std::string problem; ///< why it cannot be used; empty if it can
};

/// Sets what drivers read from the environment. To be called before GlContext::open() and listGlDevices(),
/// while there are no other threads, which might read it too. `threads`: of software renderers; 0 = all.
void prepareGlEnvironment(int threads);

/// A current OpenGL 4.5 core context without a window. There is at most one at a time.
class GlContext {
public:
    /// See devicesToTry() and findDevice(); Auto is hardware first, then software. Throws Error{NoGpu} if
    /// none of them gives such a context.
    static std::unique_ptr<GlContext> open(const DeviceRequest& request);

    ~GlContext();
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    const GlDevice& device() const { return device_; }
    const GlLimits& limits() const { return limits_; }

private:
    friend class GlDeviceList;
    GlContext() = default;

    void* display_ = nullptr; // EGLDisplay
    void* context_ = nullptr; // EGLContext
    GlDevice device_;
    GlLimits limits_;
};

/// Every device that EGL knows, each tried. Throws Error{NoGpu} if there is no EGL.
std::vector<GlDevice> listGlDevices();

} // namespace rt
