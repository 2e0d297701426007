#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rt {

inline constexpr std::size_t kCheckpointSettings = 12;

/// What an unfinished picture is one of.
struct CheckpointInfo {
    std::uint64_t atlasHash; ///< content hash of the .rtatlas
    /// Hashes of all that decides what the pixels become, but for how many samples; the renderer says which
    /// is of what.
    std::uint64_t settings[kCheckpointSettings];
    std::uint32_t size[2];   ///< of the whole picture
    std::uint32_t window[4]; ///< [xy, zw): the part that is rendered
    std::uint32_t samples;   ///< per pixel that were wanted
    std::uint32_t seed;
    double gpuMs; ///< spent so far
};
static_assert(sizeof(CheckpointInfo) == 144);

struct CheckpointTile {
    std::uint32_t samples;
    std::uint32_t goal;
};

/// The words of one of the film's images in the window.
struct CheckpointPlane {
    std::uint32_t image = 0; ///< RT_IMAGE_...
    std::vector<std::uint32_t> words = {};
};
inline constexpr std::uint32_t kCheckpointPlanes = 8;

/// An unfinished picture. What the tiles and planes have to be is the renderer's business.
struct Checkpoint {
    CheckpointInfo info{};
    std::vector<CheckpointTile> tiles;
    std::vector<CheckpointPlane> planes;
};

/// Writes it whole or not at all. Throws Error{FileAccess}.
void writeCheckpoint(const std::string& path, const Checkpoint& checkpoint);

/// Safe for untrusted files. Throws Error{FileAccess} or Error{InvalidContent}.
Checkpoint readCheckpoint(const std::string& path);

/// XXH3 of the bytes.
std::uint64_t hashOf(std::span<const std::byte> bytes);

} // namespace rt
