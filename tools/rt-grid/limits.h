#pragma once
#include "common/memory_limit.h"
#include "formats/atlas.shared.h"

#include <cstdint>
#include <string>

namespace rt {

/// 2^29 voxels of 4 bytes fill the largest storage buffer that current GL drivers offer, 2 GiB.
inline constexpr std::uint64_t kMaxVoxels = std::uint64_t(1) << 29;
inline constexpr std::uint64_t kMaxReferenceWords = 0x3FFFFFFFu; ///< list offsets have 30 bits

/// What a build has to hold in memory.
struct BuildSize {
    glm::uvec3 dims{1u};
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;
    std::uint64_t texels = 0; ///< of all texture pages
    bool vdb = false;
    bool boxes = false; ///< the structure has boxes, for whose growth each voxel has a bit
};

/// Bytes that a build needs besides the program itself, the mapped mesh file and its triangle lists:
///     voxels * (4 + 16 if a VDB file is written + 1/8 if there are boxes)
///     + triangles * (48 + 16 + 4) + vertices * 4 + texels * 4.
std::uint64_t forecastBytes(const BuildSize& size);

/// Bytes that one triangle-voxel reference costs at most while lists are built: its voxel (4), its place in
/// the list (4), and the list's exit box (4) if it is alone in it. A word of a brick costs no more: it is
/// made in memory that blocks share, kept (4), and then moved to its place (4).
inline constexpr std::uint64_t kBytesPerReference = 12;
/// The same where the bricks go into a VDB file, whose blocks of 8^3 voxels they may leave mostly empty.
inline constexpr std::uint64_t kBytesPerReferenceInVdb = 24;

inline std::uint64_t bytesPerReference(const BuildSize& size) {
    return size.vdb ? kBytesPerReferenceInVdb : kBytesPerReference;
}

/// How many references and brick words a build may make, and what to say if it makes more.
struct ReferenceLimit {
    std::uint64_t references = kMaxReferenceWords / 2;
    std::string message;
};

/// Throws Error{LimitExceeded}, message prefixed by `name`, if there are too many voxels, or if
/// forecastBytes() and one reference per triangle exceed `limit`. Otherwise returns how many references the
/// rest of `limit` has room for.
ReferenceLimit checkLimits(const std::string& name, const BuildSize& size, const MemoryLimit& limit);

} // namespace rt
