#include "tools/rt-grid/device_limits.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <string_view>

namespace rt {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

// libepoxy ends the program if a library that it needs is absent.
bool haveLibraries() {
    return dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL) &&
           (dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_GLOBAL) ||
            dlopen("libGL.so.1", RTLD_LAZY | RTLD_GLOBAL));
}

template <class Integer>
Integer atLeastZero(Integer value) {
    return value > 0 ? value : 0;
}
unsigned get(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return static_cast<unsigned>(atLeastZero(value));
}
std::uint64_t getWide(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return static_cast<std::uint64_t>(atLeastZero(value));
}

bool isSoftware(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

DeviceLimits limitsOfCurrentContext() {
    DeviceLimits limits;
    if (const GLubyte* const name = glGetString(GL_RENDERER))
        limits.name = reinterpret_cast<const char*>(name);
    limits.bufferBytes = getWide(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    // llvmpipe refuses larger textures and has no name for that limit (Mesa's LP_MAX_TEXTURE_SIZE).
    limits.textureBytes = isSoftware(limits.name) ? (1u << 30) - 1u : kNoLimit;
    limits.textureSide3D = get(GL_MAX_3D_TEXTURE_SIZE);
    limits.textureSide2D = get(GL_MAX_TEXTURE_SIZE);
    limits.arrayLayers = get(GL_MAX_ARRAY_TEXTURE_LAYERS);
    return limits;
}

// A context without a window, as long as it lives. Displays stay open until the program ends: a driver that
// is unloaded leaves memory behind.
class Context {
public:
    explicit Context(EGLDisplay display) : display_(display) {
        static constexpr EGLint kAttributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                                                 EGL_NONE};
        if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return;
        if (!eglBindAPI(EGL_OPENGL_API)) return;
        context_ = eglCreateContext(display, nullptr, EGL_NO_CONTEXT, kAttributes);
        isCurrent_ =
            context_ != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
    }
    ~Context() {
        if (context_ == EGL_NO_CONTEXT) return;
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglReleaseThread();
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    bool isCurrent() const { return isCurrent_; }

private:
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
    bool isCurrent_ = false;
};

} // namespace

DeviceLimits guaranteedLimits() {
    return {"any OpenGL 4.5 device", std::uint64_t(1) << 27, kNoLimit, 2048, 16384, 2048};
}

std::optional<DeviceLimits> limitsOfThisDevice() {
    setenv("EGL_LOG_LEVEL", "fatal", 0); // Mesa's remarks on devices that it cannot open
    if (!haveLibraries()) return std::nullopt;
    const auto queryDevices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const auto getDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    if (!queryDevices || !getDisplay || !queryDevices(EGLint(devices.size()), devices.data(), &count))
        return std::nullopt;
    std::optional<DeviceLimits> software;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const Context context(getDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        if (!context.isCurrent()) continue;
        DeviceLimits limits = limitsOfCurrentContext();
        if (!isSoftware(limits.name)) return limits;
        if (!software) software = std::move(limits);
    }
    return software;
}

} // namespace rt
