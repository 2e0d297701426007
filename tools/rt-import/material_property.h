#pragma once
#include "formats/material.shared.h"

#include <optional>
#include <string>

struct aiMaterial;

namespace rt {

/// What Assimp's AI_MATKEY_* macros expand to.
struct MaterialKey {
    const char* name;
    unsigned type;
    unsigned index;
};

/// A property of a material; nothing where it has none of that name and kind. Numbers are finite.
std::optional<float> findNumber(const aiMaterial& source, MaterialKey key);
std::optional<int> findInteger(const aiMaterial& source, MaterialKey key);
std::optional<std::string> findText(const aiMaterial& source, MaterialKey key);
std::optional<vec4> findColor(const aiMaterial& source, MaterialKey key); ///< may be out of any range

/// The number, or `fallback`.
float numberOr(const aiMaterial& source, MaterialKey key, float fallback);

/// Within [lo, hi]; lo for what is not a number.
float clampNumber(float value, float lo, float hi);
vec3 clampColor(const vec4& color, float hi);

} // namespace rt
