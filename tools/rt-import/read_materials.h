#pragma once
#include "formats/material.shared.h"

#include <optional>
#include <string>
#include <vector>

struct aiMaterial;

namespace rt {

/// A base-colour texture as the model file names it.
struct TextureSource {
    std::string name; ///< a file name, or what Assimp calls an image inside the model ("*0")
    std::uint32_t wrapU = kWrapRepeat;
    std::uint32_t wrapV = kWrapRepeat;
    std::uint32_t uvChannel = 0; ///< which of a mesh's sets of texture coordinates it uses
};

struct MaterialSource {
    std::string name;
    Material material; ///< images.x not yet set
    std::optional<TextureSource> texture;
};

/// Maps a file's material to ours, by the table in README.md. Whatever the file says, the result is valid:
/// numbers are finite and clamped to their ranges. What cannot be carried over adds a warning.
MaterialSource readMaterial(const aiMaterial& source, std::vector<std::string>& warnings);

} // namespace rt
