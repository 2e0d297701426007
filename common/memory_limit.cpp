#include "common/memory_limit.h"

#include <algorithm>
#include <fstream>
#include <unistd.h>

namespace rt {
namespace {

constexpr std::uint64_t kUnknown = ~std::uint64_t(0);

std::uint64_t physicalBytes() {
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long pageBytes = sysconf(_SC_PAGESIZE);
    if (pages <= 0 || pageBytes <= 0) return kUnknown;
    return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(pageBytes);
}

// kUnknown if there is no such file, or no number in it: "max" stands for no limit.
std::uint64_t numberIn(const std::string& path) {
    std::uint64_t number = 0;
    return std::ifstream(path) >> number ? number : kUnknown;
}

} // namespace

MemoryLimit defaultMemoryLimit(const std::string& cgroupFolder) {
    const std::uint64_t machine = physicalBytes();
    const std::uint64_t group = std::min(numberIn(cgroupFolder + "/memory.max"),
                                         numberIn(cgroupFolder + "/memory/memory.limit_in_bytes"));
    if (group < machine) return {group / 4 * 3, "75 % of this control group's memory"};
    return {machine / 4 * 3, "75 % of this machine's memory"};
}

} // namespace rt
