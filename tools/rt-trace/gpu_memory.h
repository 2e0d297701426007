#pragma once
#include "common/memory_limit.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt {

struct GlDevice;

/// What the driver says of a device's memory; nothing where it does not.
struct GpuMemory {
    std::optional<std::uint64_t> bytes;
    std::optional<std::uint64_t> freeBytes;
};

/// Of the current context, from GL_NVX_gpu_memory_info or GL_ATI_meminfo.
GpuMemory queryGpuMemory();

/// Something that is to lie in the device's memory.
struct MemoryNeed {
    const char* what;
    std::uint64_t bytes = 0;
    const char* remedy; ///< makes it smaller
};
std::uint64_t sumOf(const std::vector<MemoryNeed>& needs);

/// How much may lie there: what is free, software devices have the machine's memory, but not more than `most`
/// (--max-gpu-memory). Nothing where nobody tells.
std::optional<MemoryLimit> gpuMemoryLimit(const GlDevice& device, std::optional<std::uint64_t> most);

/// Throws Error{LimitExceeded}, message prefixed by `name`, if all of it together exceeds the limit.
void requireGpuMemory(const std::vector<MemoryNeed>& needs, const std::optional<MemoryLimit>& limit,
                      const std::string& name);

} // namespace rt
