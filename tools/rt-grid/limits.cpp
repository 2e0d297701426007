#include "tools/rt-grid/limits.h"

#include "common/error.h"

#include <fmt/format.h>

namespace rt {
namespace {

// Rounded up; small ones in KiB, so that they do not look like the limit that they exceed.
std::string inMebibytes(std::uint64_t bytes) {
    if (bytes < 16u << 20) return fmt::format("{} KiB", (bytes + 1023) >> 10);
    return fmt::format("{} MiB", (bytes + (1u << 20) - 1) >> 20);
}

} // namespace

std::uint64_t forecastBytes(const BuildSize& size) {
    const std::uint64_t voxels = std::uint64_t(size.dims.x) * size.dims.y * size.dims.z;
    return voxels * (size.vdb ? 20u : 4u) + (size.boxes ? voxels / 8u : 0u) + size.triangles * 68u +
           size.vertices * 4u + size.texels * 4u;
}

ReferenceLimit checkLimits(const std::string& name, const BuildSize& size, const MemoryLimit& limit) {
    const glm::uvec3& d = size.dims; // at most 2^16 each: the product fits
    const std::uint64_t voxels = std::uint64_t(d.x) * d.y * d.z;
    const std::string request =
        fmt::format("{}: a grid of {}x{}x{} = {} voxels", name, d.x, d.y, d.z, voxels);
    if (voxels > kMaxVoxels)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{} would need {} for its voxels alone; at most {} (2^29) voxels are possible; "
                        "lower --resolution",
                        request, inMebibytes(voxels * 4u), kMaxVoxels));
    const std::string remedy =
        fmt::format("the limit is {} ({}); lower --resolution or --density, or raise --max-memory",
                    inMebibytes(limit.bytes), limit.origin);
    const std::uint64_t fixed = forecastBytes(size);
    const std::uint64_t least = fixed + size.triangles * bytesPerReference(size);
    if (least > limit.bytes)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{} for {} triangles needs at least {}; {}", request, size.triangles,
                                inMebibytes(least), remedy));
    const std::uint64_t inMemory = (limit.bytes - fixed) / bytesPerReference(size);
    if (inMemory < kMaxReferenceWords / 2)
        return {
            inMemory,
            fmt::format("{} needs {} and more than {} triangle references and brick words of {} bytes; {}",
                        request, inMebibytes(fixed), inMemory, bytesPerReference(size), remedy)};
    return {kMaxReferenceWords / 2,
            fmt::format(
                "{} has more than {} triangle references and brick words, the most that offsets can reach; "
                "lower --resolution or --density",
                request, kMaxReferenceWords / 2)};
}

} // namespace rt
