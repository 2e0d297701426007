#include "tools/rt-import/material_property.h"

#include <assimp/material.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

template <class T>
std::optional<T> find(const aiMaterial& source, MaterialKey key) {
    T value{};
    if (source.Get(key.name, key.type, key.index, value) != aiReturn_SUCCESS) return std::nullopt;
    return value;
}

} // namespace

std::optional<float> findNumber(const aiMaterial& source, MaterialKey key) {
    const auto value = find<ai_real>(source, key);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> findInteger(const aiMaterial& source, MaterialKey key) {
    return find<int>(source, key);
}

std::optional<std::string> findText(const aiMaterial& source, MaterialKey key) {
    const auto value = find<aiString>(source, key);
    return value ? std::optional<std::string>(value->C_Str()) : std::nullopt;
}

std::optional<vec4> findColor(const aiMaterial& source, MaterialKey key) {
    const auto value = find<aiColor4D>(source, key);
    return value ? std::optional<vec4>(vec4(value->r, value->g, value->b, value->a)) : std::nullopt;
}

float numberOr(const aiMaterial& source, MaterialKey key, float fallback) {
    return findNumber(source, key).value_or(fallback);
}

float clampNumber(float value, float lo, float hi) {
    return std::isfinite(value) ? std::clamp(value, lo, hi) : lo;
}

vec3 clampColor(const vec4& color, float hi) {
    return {clampNumber(color.r, 0.0f, hi), clampNumber(color.g, 0.0f, hi), clampNumber(color.b, 0.0f, hi)};
}

} // namespace rt
