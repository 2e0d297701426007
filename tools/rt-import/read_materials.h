#pragma once
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_textures.h"

namespace rt {

struct MaterialSource {
    std::string name;
    Material material; ///< its images are not yet set
    TextureSources textures;
};

/// Maps a file's material to ours, by the table in README.md. Whatever the file says, the result is valid:
/// numbers are finite and clamped to their ranges. What cannot be carried over adds a warning.
MaterialSource readMaterial(const aiMaterial& source, const GltfMaterialExtras& extras,
                            std::vector<std::string>& warnings);

/// Takes a texture away. The factor that it would have scaled counts as 0 then, not as everywhere 1; only a
/// base colour or a roughness stays as its factor.
void dropTexture(MaterialSource& source, TextureUse use);

} // namespace rt
