#include "tools/rt-trace/gpu_memory.h"

#include "common/error.h"
#include "tools/rt-trace/gl_context.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

constexpr const char* kMostOption = "--max-gpu-memory";

std::uint64_t kilobytesOf(GLenum name) {
    GLint values[4] = {}; // GL_ATI_meminfo tells more than the total
    glGetIntegerv(name, values);
    return static_cast<std::uint64_t>(std::max(values[0], 0)) << 10;
}

std::string toMiB(std::uint64_t bytes) {
    return fmt::format("{} MiB", (bytes + (1u << 20) - 1) >> 20);
}

} // namespace

GpuMemory queryGpuMemory() {
    if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info"))
        return {kilobytesOf(GL_GPU_MEMORY_INFO_DEDICATED_VIDMEM_NVX),
                kilobytesOf(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX)};
    if (epoxy_has_gl_extension("GL_ATI_meminfo"))
        return {std::nullopt, kilobytesOf(GL_TEXTURE_FREE_MEMORY_ATI)};
    return {};
}

std::uint64_t sumOf(const std::vector<MemoryNeed>& needs) {
    std::uint64_t sum = 0;
    for (const MemoryNeed& need : needs) sum += need.bytes;
    return sum;
}

std::optional<MemoryLimit> gpuMemoryLimit(const GlDevice& device, std::optional<std::uint64_t> most) {
    std::optional<MemoryLimit> limit;
    if (device.software)
        limit = defaultMemoryLimit();
    else if (device.memory.freeBytes)
        limit = MemoryLimit{*device.memory.freeBytes, "free on the device"};
    if (most && (!limit || *most < limit->bytes)) limit = MemoryLimit{*most, kMostOption};
    return limit;
}

void requireGpuMemory(const std::vector<MemoryNeed>& needs, const std::optional<MemoryLimit>& limit,
                      const std::string& name) {
    if (!limit || sumOf(needs) <= limit->bytes) return;
    std::string parts;
    for (const MemoryNeed& need : needs)
        if (need.bytes > 0)
            parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", need.what, toMiB(need.bytes));
    const auto largest =
        std::max_element(needs.begin(), needs.end(),
                         [](const MemoryNeed& a, const MemoryNeed& b) { return a.bytes < b.bytes; });
    throw Error(ErrorKind::LimitExceeded,
                fmt::format("{}: needs {} of the device's memory ({}), the limit is {} ({}); {} or {}", name,
                            toMiB(sumOf(needs)), parts, toMiB(limit->bytes), limit->origin, largest->remedy,
                            limit->origin == kMostOption ? "raise it" : "use another --device"));
}

} // namespace rt
