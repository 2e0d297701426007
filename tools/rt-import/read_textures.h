#pragma once
#include "formats/material.shared.h"

#include <glm/mat3x2.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

struct aiMaterial;

namespace rt {

/// What the images of a material are for.
enum class TextureUse : unsigned { BaseColor, Roughness, Normals, Emission, Transmission };
inline constexpr std::size_t kTextureUses = 5;
const char* nameOf(TextureUse use);

/// A texture as the model file names it.
struct TextureSource {
    std::string name; ///< a file name, or what Assimp calls an image inside the model ("*0"); empty = white
    std::string alphaName; ///< the image whose alpha (or else red) is its alpha, `name` too; empty = opaque
    std::uint32_t wrapU = kWrapRepeat;
    std::uint32_t wrapV = kWrapRepeat;
    std::uint32_t uvChannel = 0;            ///< which of a mesh's sets of texture coordinates it uses
    glm::mat3x2 uvTransform = kNoTransform; ///< texture coordinate from the mesh's, which is (u, v, 1)
    bool isPath = false;       ///< the names are paths of files, known not to be inside the model
    bool mayBeHeights = false; ///< a bump map: normals only if it looks like them

    static constexpr glm::mat3x2 kNoTransform{1, 0, 0, 1, 0, 0};
};

using TextureSources = std::array<std::optional<TextureSource>, kTextureUses>;

/// The textures of a material that have a place in ours. What has none is added to `lost`.
TextureSources readTextures(const aiMaterial& source, std::vector<std::string>& lost);

/// Removes textures that use other texture coordinates than the first one of the material, and tells which
/// ones.
std::vector<TextureUse> keepOneSetOfCoordinates(TextureSources& textures);

} // namespace rt
