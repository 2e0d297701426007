#include "tools/rt-trace/gl_context.h"

#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/device_choice.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cstdlib>
#include <optional>

namespace rt {
namespace {

struct EglCandidate {
    EGLenum platform = 0;
    void* device = nullptr; // EGLDeviceEXT, or nothing for the platform's default
    ListedDevice listed = {};
};

template <class Function>
Function extensionFunction(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

// libepoxy ends the program if a library that it needs is absent; so they are looked for first.
void requireLibraries() {
    if (!dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL))
        throw Error(ErrorKind::NoGpu,
                    "libEGL.so.1 is not there; install libegl1 and a driver, such as libgl1-mesa-dri");
    if (!dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_GLOBAL) && !dlopen("libGL.so.1", RTLD_LAZY | RTLD_GLOBAL))
        throw Error(ErrorKind::NoGpu, "neither libOpenGL.so.0 nor libGL.so.1 is there; install libopengl0");
}

std::vector<EglCandidate> deviceCandidates() {
    const auto queryDevices = extensionFunction<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto queryDeviceString =
        extensionFunction<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    EGLint count = 0;
    if (!queryDevices || !queryDeviceString || !queryDevices(0, nullptr, &count) || count <= 0) return {};
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (!queryDevices(count, devices.data(), &count)) return {};
    const auto queryDeviceAttribute =
        extensionFunction<PFNEGLQUERYDEVICEATTRIBEXTPROC>("eglQueryDeviceAttribEXT");
    std::vector<EglCandidate> candidates;
    for (EGLDeviceEXT device : devices) {
        const char* const extensions = queryDeviceString(device, EGL_EXTENSIONS);
        const auto queryAttribute = [&](EGLint attribute) -> std::optional<std::intptr_t> {
            EGLAttrib value = 0;
            if (!queryDeviceAttribute || !queryDeviceAttribute(device, attribute, &value))
                return std::nullopt;
            return value;
        };
        candidates.push_back(
            {EGL_PLATFORM_DEVICE_EXT,
             device,
             {hasExtension(extensions, "EGL_MESA_device_software"), cudaNumber(extensions, queryAttribute)}});
    }
    return candidates;
}

std::vector<EglCandidate> findCandidates() {
    const char* const extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<EglCandidate> candidates;
    if (hasExtension(extensions, "EGL_EXT_platform_device") &&
        (hasExtension(extensions, "EGL_EXT_device_base") ||
         hasExtension(extensions, "EGL_EXT_device_enumeration")))
        candidates = deviceCandidates();
    if (candidates.empty() && hasExtension(extensions, "EGL_MESA_platform_surfaceless"))
        candidates.push_back({EGL_PLATFORM_SURFACELESS_MESA, nullptr});
    if (candidates.empty()) candidates.push_back({});
    return candidates;
}

EGLDisplay displayOf(const EglCandidate& candidate) {
    if (candidate.platform == 0) return eglGetDisplay(EGL_DEFAULT_DISPLAY);
    const auto getDisplay = extensionFunction<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    return getDisplay ? getDisplay(candidate.platform, candidate.device, nullptr) : EGL_NO_DISPLAY;
}

std::string failed(const char* what) {
    return fmt::format("{} failed (EGL error 0x{:04x})", what, eglGetError());
}

// A context that is made current, or EGL_NO_CONTEXT and why. `display` is initialized.
EGLContext makeContext(EGLDisplay display, std::string& problem) {
    const char* const extensions = eglQueryString(display, EGL_EXTENSIONS);
    EGLConfig config = nullptr; // EGL_NO_CONFIG_KHR
    if (!hasExtension(extensions, "EGL_KHR_no_config_context") &&
        !hasExtension(extensions, "EGL_MESA_configless_context")) {
        const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                 EGL_NONE};
        EGLint count = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) {
            problem = failed("eglChooseConfig");
            return EGL_NO_CONTEXT;
        }
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    const bool bound = eglBindAPI(EGL_OPENGL_API);
    const EGLContext context =
        bound ? eglCreateContext(display, config, EGL_NO_CONTEXT, attributes) : EGL_NO_CONTEXT;
    if (context == EGL_NO_CONTEXT) {
        problem = "no OpenGL 4.5 core context: " + failed("eglCreateContext");
    } else if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        problem = failed("eglMakeCurrent");
        eglDestroyContext(display, context);
        return EGL_NO_CONTEXT;
    }
    return context;
}

std::string glString(GLenum name) {
    const GLubyte* const text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "unknown";
}

// Drivers that find no GPU behind a hardware device may fall back to one of these.
bool isSoftwareRenderer(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

// As many as it likes: a shader is one, and there are two at most.
void letDriverCompileOnItsOwnThreads() {
    constexpr GLuint kNoLimit = 0xFFFFFFFFu;
    if (epoxy_has_gl_extension("GL_KHR_parallel_shader_compile"))
        glMaxShaderCompilerThreadsKHR(kNoLimit);
    else if (epoxy_has_gl_extension("GL_ARB_parallel_shader_compile"))
        glMaxShaderCompilerThreadsARB(kNoLimit);
}

} // namespace

void prepareGlEnvironment(int threads) {
    setenv("EGL_LOG_LEVEL", "fatal", 0); // Mesa's remarks on devices that it cannot open
    if (threads > 0) setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 1);
}

/// The devices of this machine, and how to open one.
class GlDeviceList {
public:
    GlDeviceList() {
        requireLibraries();
        candidates_ = findCandidates();
    }

    std::size_t size() const { return candidates_.size(); }
    std::vector<ListedDevice> listed() const {
        std::vector<ListedDevice> list;
        for (const EglCandidate& candidate : candidates_) list.push_back(candidate.listed);
        return list;
    }

    // Returns nothing, and device.problem says why, if there is no usable context on it.
    std::unique_ptr<GlContext> tryOpen(std::size_t i, GlDevice& device) const {
        device = {};
        device.index = static_cast<unsigned>(i);
        device.software = candidates_[i].listed.software;
        device.cuda = candidates_[i].listed.cuda;
        std::unique_ptr<GlContext> opened(new GlContext);
        const EGLDisplay display = displayOf(candidates_[i]);
        if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
            device.problem = failed("eglInitialize");
            return nullptr;
        }
        opened->display_ = display;
        opened->context_ = makeContext(display, device.problem);
        if (opened->context_ == EGL_NO_CONTEXT) return nullptr;
        device.renderer = glString(GL_RENDERER);
        device.version = glString(GL_VERSION);
        device.driver = glString(GL_VENDOR);
        device.software = device.software || isSoftwareRenderer(device.renderer);
        device.memory = queryGpuMemory();
        opened->device_ = device;
        opened->limits_ = queryGlLimits(device.software);
        letDriverCompileOnItsOwnThreads();
        return opened;
    }

    std::unique_ptr<GlContext> openFirst(bool software, std::string& problems) const {
        for (const std::size_t i : devicesToTry(listed(), software)) {
            GlDevice device;
            std::unique_ptr<GlContext> context = tryOpen(i, device);
            if (context && device.software == software) return context;
            if (!device.problem.empty()) problems += fmt::format("; device {}: {}", i, device.problem);
        }
        return nullptr;
    }

    std::unique_ptr<GlContext> openOne(const DeviceRequest& request, std::string& problems) const {
        const std::size_t index = findDevice(request, listed());
        GlDevice device;
        std::unique_ptr<GlContext> context = tryOpen(index, device);
        if (!context) problems = fmt::format("; device {}: {}", index, device.problem);
        return context;
    }

private:
    std::vector<EglCandidate> candidates_;
};

std::unique_ptr<GlContext> GlContext::open(const DeviceRequest& request) {
    using Kind = DeviceRequest::Kind;
    const GlDeviceList devices;
    std::string problems;
    std::unique_ptr<GlContext> context;
    if (request.kind == Kind::Index || request.kind == Kind::Cuda) {
        context = devices.openOne(request, problems);
    } else {
        if (request.kind == Kind::Auto) context = devices.openFirst(false, problems);
        if (!context) {
            problems.clear(); // the second round tries the same devices again
            context = devices.openFirst(true, problems);
        }
    }
    if (!context)
        throw Error(ErrorKind::NoGpu,
                    fmt::format("no device gives an OpenGL 4.5 core context{}; Mesa's software renderer "
                                "comes with libgl1-mesa-dri and libegl-mesa0",
                                problems));
    const GlDevice& used = context->device();
    logInfo(fmt::format("device {}: {} ({}, GL {})", used.index, used.renderer,
                        used.software ? "software" : "hardware", used.version));
    return context;
}

// Displays belong to the process: one that is open already is found again by its device, and the driver
// behind it stays loaded.
GlContext::~GlContext() {
    if (!context_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglReleaseThread();
}

std::vector<GlDevice> listGlDevices() {
    const GlDeviceList devices;
    std::vector<GlDevice> list(devices.size());
    for (std::size_t i = 0; i < list.size(); ++i) devices.tryOpen(i, list[i]);
    return list;
}

} // namespace rt
