#pragma once
#include "tools/rt-import/read_materials.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rt {

class JsonNode;
class ModelFolder;

/// What a scene file says of the materials whose names match; the rest stays as their model has it.
struct MaterialOverride {
    std::string pattern; ///< * stands for any text, ? for any character
    std::string place;   ///< "x.scene.json: /materials/0", for messages
    std::optional<vec3> baseColor, emission, attenuationColor;
    std::optional<float> opacity, opacityCutoff, metallic, roughness, specular, mirror, transmission, ior,
        attenuationDistance, normalScale;
    std::optional<bool> thin, unlit;
    std::array<std::optional<std::string>, kTextureUses> textures; ///< paths; empty: the image is taken away
};

/// Reads one of a scene file, whose textures lie in `folder`. Throws Error{InvalidContent}.
MaterialOverride readOverride(const JsonNode& json, const ModelFolder& folder);

/// Whether all of the name is as the pattern says, letter case included.
bool matches(const std::string& pattern, const std::string& name);

/// Changes the material. One that gets metal, roughness, transmission or an index of refraction reflects by
/// Fresnel's equations from then on, unless the override says otherwise.
void applyOverride(const MaterialOverride& change, MaterialSource& material);

} // namespace rt
