#pragma once
#include "tools/rt-trace/film.h"
#include "tools/rt-trace/picture_setup.h"
#include "tools/rt-trace/tile_samples.h"

#include <array>
#include <string>

namespace rt {

/// What makes two runs render the same picture. More samples go on with the same one.
struct PictureIdentity {
    std::uint64_t atlasHash = 0;
    std::array<std::uint64_t, kCheckpointSettings> settings{}; ///< hashes, see checkpoint.cpp
    glm::uvec2 size{0};
    glm::uvec4 window{0};
    std::uint32_t seed = 0;
    std::uint32_t samples = 0;
};
/// What the hash with this index is of, in a user's words.
const char* settingName(std::size_t index);
PictureIdentity identityOf(const TraceOptions& options, const PictureSetup& setup,
                           const SceneFeatures& features, std::uint64_t atlasHash);

/// Throws Error{FileAccess}.
void saveCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                    const TileSamples& tiles, double gpuMs);

/// Puts a picture back as it was saved; returns the milliseconds that were spent on it. Throws
/// Error{FileAccess}, Error{InvalidContent} if it is damaged or another picture's, or Error{Usage} if it has
/// more samples than are wanted.
double resumeCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                        TileSamples& tiles);

} // namespace rt
