#include "tools/rt-import/read_materials.h"

#include "formats/mesh.h"

#include <assimp/GltfMaterial.h>
#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr float kDefaultGrey = 0.8f;
constexpr float kGlassIor = 1.5f;
constexpr float kMaxIor = 100.0f;

struct Key {
    const char* name;
    unsigned type;
    unsigned index;
};

// Assimp's AI_MATKEY_* macros expand to these three.
template <class T>
std::optional<T> get(const aiMaterial& source, Key key) {
    T value{};
    if (source.Get(key.name, key.type, key.index, value) != aiReturn_SUCCESS) return std::nullopt;
    return value;
}

float number(const aiMaterial& source, Key key, float fallback) {
    const float value = get<ai_real>(source, key).value_or(fallback);
    return std::isfinite(value) ? value : fallback;
}

float clampNumber(float value, float lo, float hi) {
    return std::isfinite(value) ? std::clamp(value, lo, hi) : lo;
}

vec4 clampColor(const aiColor4D& color, float hi, float alpha) {
    return {clampNumber(color.r, 0.0f, hi), clampNumber(color.g, 0.0f, hi), clampNumber(color.b, 0.0f, hi),
            alpha};
}

// GetTextureCount() would not do: Assimp keeps glTF's thickness as the second of the transmission textures.
bool hasTexture(const aiMaterial& source, aiTextureType type) {
    return get<aiString>(source, {AI_MATKEY_TEXTURE(type, 0)}).has_value();
}

struct Optics {
    float reflectivity;
    float transmission;
    float ior;
};

// illum 2 has a highlight only; 3 and above ask for ray-traced mirrors, 4, 6, 7 and 9 for glass.
Optics readMtlOptics(const aiMaterial& source, int illum) {
    const bool mirrors = illum >= 3 && illum <= 9;
    const bool glass = illum == 4 || illum == 6 || illum == 7 || illum == 9;
    const aiColor4D specular =
        get<aiColor4D>(source, {AI_MATKEY_COLOR_SPECULAR}).value_or(aiColor4D(0, 0, 0, 0));
    const float ior = number(source, {AI_MATKEY_REFRACTI}, 1.0f); // 1 also where the file has no Ni
    return {mirrors ? std::max({specular.r, specular.g, specular.b}) : 0.0f,
            1.0f - number(source, {AI_MATKEY_OPACITY}, 1.0f), glass && ior <= 1.0f ? kGlassIor : ior};
}

Optics readGltfOptics(const aiMaterial& source, const std::string& alphaMode,
                      std::vector<std::string>& lost) {
    // A rough metal scatters; only the smooth part of it is a mirror.
    float mirror = number(source, {AI_MATKEY_METALLIC_FACTOR}, 0.0f) *
                   (1.0f - number(source, {AI_MATKEY_ROUGHNESS_FACTOR}, 1.0f));
    if (mirror > 0.0f && hasTexture(source, aiTextureType_METALNESS)) {
        mirror = 0.0f;
        lost.emplace_back("metalness texture");
    }
    float transmission = number(source, {AI_MATKEY_TRANSMISSION_FACTOR}, 0.0f);
    if (transmission > 0.0f && hasTexture(source, aiTextureType_TRANSMISSION)) {
        transmission = 0.0f;
        lost.emplace_back("transmission texture");
    }
    if (alphaMode == "MASK") lost.emplace_back("alpha mask");
    if (transmission <= 0.0f && alphaMode == "BLEND") // coverage: light passes without bending
        return {mirror, 1.0f - number(source, {AI_MATKEY_OPACITY}, 1.0f), 1.0f};
    return {mirror, transmission, number(source, {AI_MATKEY_REFRACTI}, kGlassIor)};
}

Optics readOptics(const aiMaterial& source, std::vector<std::string>& lost) {
    if (const auto illum = get<int>(source, {AI_MATKEY_OBJ_ILLUM})) return readMtlOptics(source, *illum);
    if (const auto alphaMode = get<aiString>(source, {AI_MATKEY_GLTF_ALPHAMODE}))
        return readGltfOptics(source, alphaMode->C_Str(), lost);
    return {number(source, {AI_MATKEY_REFLECTIVITY}, 0.0f), 1.0f - number(source, {AI_MATKEY_OPACITY}, 1.0f),
            number(source, {AI_MATKEY_REFRACTI}, 1.0f)};
}

vec4 clampOptics(const Optics& optics) {
    const float transmission = clampNumber(optics.transmission, 0.0f, 1.0f);
    // Opacity is stated outright, mirrors are often guesses of an exporter: what is let through comes first.
    const float reflectivity = clampNumber(optics.reflectivity, 0.0f, 1.0f - transmission);
    const float rest = reflectivity < 1.0f ? transmission / (1.0f - reflectivity) : 0.0f;
    return {reflectivity, rest, clampNumber(optics.ior, 1.0f, kMaxIor), 0.0f};
}

std::uint32_t wrapOf(const aiMaterial& source, Key key) {
    switch (get<int>(source, key).value_or(aiTextureMapMode_Wrap)) {
    case aiTextureMapMode_Clamp:
    case aiTextureMapMode_Decal:
        return kWrapClamp;
    case aiTextureMapMode_Mirror:
        return kWrapMirror;
    default:
        return kWrapRepeat;
    }
}

bool isIdentity(const aiUVTransform& t) {
    return t.mTranslation == aiVector2D(0, 0) && t.mScaling == aiVector2D(1, 1) && t.mRotation == 0.0f;
}

std::optional<TextureSource> readTexture(const aiMaterial& source, std::vector<std::string>& lost) {
    const auto type =
        hasTexture(source, aiTextureType_BASE_COLOR) ? aiTextureType_BASE_COLOR : aiTextureType_DIFFUSE;
    const auto name = get<aiString>(source, {AI_MATKEY_TEXTURE(type, 0)});
    if (!name || name->length == 0) return std::nullopt;
    if (!isIdentity(get<aiUVTransform>(source, {AI_MATKEY_UVTRANSFORM(type, 0)}).value_or(aiUVTransform())))
        lost.emplace_back("texture transform");
    return TextureSource{
        name->C_Str(), wrapOf(source, {AI_MATKEY_MAPPINGMODE_U(type, 0)}),
        wrapOf(source, {AI_MATKEY_MAPPINGMODE_V(type, 0)}),
        static_cast<std::uint32_t>(std::max(0, get<int>(source, {AI_MATKEY_UVWSRC(type, 0)}).value_or(0)))};
}

vec4 readEmission(const aiMaterial& source, std::vector<std::string>& lost) {
    const auto color = get<aiColor4D>(source, {AI_MATKEY_COLOR_EMISSIVE});
    if (!color || (color->r <= 0.0f && color->g <= 0.0f && color->b <= 0.0f)) return vec4(0.0f);
    if (hasTexture(source, aiTextureType_EMISSIVE)) { // the factor alone would make the whole surface glow
        lost.emplace_back("emission texture");
        return vec4(0.0f);
    }
    return clampColor(*color * number(source, {AI_MATKEY_EMISSIVE_INTENSITY}, 1.0f),
                      std::numeric_limits<float>::max(), 0.0f);
}

// Assimp makes materials up where a file has none: named so, or for PLY nameless and pure white.
bool isMadeUp(const std::string& name, const aiColor4D& color, const aiMaterial& source) {
    const bool gltf = get<aiString>(source, {AI_MATKEY_GLTF_ALPHAMODE}).has_value();
    return name == AI_DEFAULT_MATERIAL_NAME || (name.empty() && !gltf && color == aiColor4D(1, 1, 1, 1));
}

vec4 readBaseColor(const aiMaterial& source, const std::string& name, bool textured) {
    const aiColor4D white(1, 1, 1, 1);
    const auto diffuse = get<aiColor4D>(source, {AI_MATKEY_COLOR_DIFFUSE});
    aiColor4D color = get<aiColor4D>(source, {AI_MATKEY_BASE_COLOR}).value_or(diffuse.value_or(white));
    if (!textured && isMadeUp(name, color, source))
        color = aiColor4D(kDefaultGrey, kDefaultGrey, kDefaultGrey, 1);
    return clampColor(color, 1.0f, 1.0f);
}

} // namespace

MaterialSource readMaterial(const aiMaterial& source, std::vector<std::string>& warnings) {
    std::vector<std::string> lost;
    MaterialSource result{{}, diffuseMaterial(vec3(1.0f)), {}};
    result.name = get<aiString>(source, {AI_MATKEY_NAME}).value_or(aiString()).C_Str();
    result.texture = readTexture(source, lost);
    result.material.baseColor = readBaseColor(source, result.name, result.texture.has_value());
    result.material.emission = readEmission(source, lost);
    const vec4 optics = clampOptics(readOptics(source, lost));
    result.material.reflection.y = optics.x > 0.0f || optics.y > 0.0f ? 0.0f : 1.0f;
    result.material.reflection.w = optics.x;
    result.material.transmission.x = optics.y;
    result.material.transmission.y = optics.z;
    for (const std::string& what : lost)
        warnings.push_back(fmt::format("material '{}': its {} is not carried over", result.name, what));
    return result;
}

} // namespace rt
