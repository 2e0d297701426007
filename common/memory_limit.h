#pragma once
#include <cstdint>
#include <string>

namespace rt {

/// How much memory something may use, and where that number comes from, for messages.
struct MemoryLimit {
    std::uint64_t bytes = 0;
    std::string origin;
};

/// 75 % of the machine's physical memory or of what its control group (a container, say) may use, whichever
/// is less; no limit if the system tells neither. `cgroupFolder` is where control groups are mounted:
/// memory.max in it is read (version 2), and memory/memory.limit_in_bytes (version 1).
MemoryLimit defaultMemoryLimit(const std::string& cgroupFolder = "/sys/fs/cgroup");

} // namespace rt
