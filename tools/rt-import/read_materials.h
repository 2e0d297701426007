#pragma once
#include "tools/rt-import/read_gltf_extras.h"
#include "tools/rt-import/read_textures.h"

namespace rt {

inline constexpr float kGlassIor = 1.5f; ///< where a material is glass and does not say of which kind
inline constexpr float kMaxIor = 100.0f;

struct MaterialSource {
    std::string name;
    Material material; ///< its images are not yet set
    TextureSources textures;
};

/// Maps a file's material to ours, by the table in README.md. Whatever the file says, the result is valid:
/// numbers are finite and clamped to their ranges. What cannot be carried over adds a warning.
MaterialSource readMaterial(const aiMaterial& source, const GltfMaterialExtras& extras,
                            std::vector<std::string>& warnings);

/// Leaves the base colour and the opacity alone, as an unlit material shows nothing else.
void keepBaseColorOnly(MaterialSource& source);

/// Notes whether the opacity counts: of the material itself or of its image.
void markClear(MaterialSource& source);

} // namespace rt
