#include "tools/rt-import/read_materials.h"

#include "formats/mesh.h"
#include "tools/rt-import/material_property.h"

#include <assimp/GltfMaterial.h>
#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace rt {
namespace {

constexpr float kDefaultGrey = 0.8f;
constexpr MaterialKey kGltfUnlit{"$mat.gltf.unlit", 0, 0}; // Assimp names it in a deprecated header only

std::optional<TextureSource>& textureOf(MaterialSource& source, TextureUse use) {
    return source.textures[static_cast<unsigned>(use)];
}

float share(float value) {
    return clampNumber(value, 0.0f, 1.0f);
}

// Opacity is stated outright, mirrors are often guesses of an exporter: what is let through comes first.
void setOptics(Material& material, float mirror, float transmission, float ior) {
    const float through = share(transmission);
    material.reflection.w = clampNumber(mirror, 0.0f, 1.0f - through);
    const float rest = 1.0f - material.reflection.w; // of which our transmission is a part
    material.transmission.x = rest > 0.0f ? share(through / rest) : 0.0f;
    material.transmission.y = clampNumber(ior, 1.0f, kMaxIor);
    if (material.transmission.x > 0.0f) material.reflection.y = 0.0f; // clear, unless the file says more
}

// illum 2 has a highlight only; 3 and above ask for ray-traced mirrors, 4, 6, 7 and 9 for glass, 5 and 7 for
// Fresnel's equations.
void readMtlOptics(const aiMaterial& source, int illum, Material& material) {
    const bool mirrors = illum >= 3 && illum <= 9;
    const bool glass = illum == 4 || illum == 6 || illum == 7 || illum == 9;
    const vec4 specular = findColor(source, {AI_MATKEY_COLOR_SPECULAR}).value_or(vec4(0.0f));
    const float ior = numberOr(source, {AI_MATKEY_REFRACTI}, 1.0f); // 1 also where the file has no Ni
    setOptics(material, mirrors ? std::max({specular.r, specular.g, specular.b}) : 0.0f,
              1.0f - numberOr(source, {AI_MATKEY_OPACITY}, 1.0f), glass && ior <= 1.0f ? kGlassIor : ior);
    const auto metallic = findNumber(source, {AI_MATKEY_METALLIC_FACTOR});   // Pm
    const auto roughness = findNumber(source, {AI_MATKEY_ROUGHNESS_FACTOR}); // Pr
    material.reflection.x = share(metallic.value_or(0.0f));
    material.reflection.y = share(roughness.value_or(material.reflection.y));
    material.reflection.z = illum == 5 || illum == 7 || metallic || roughness ? 1.0f : 0.0f;
}

void readVolume(const aiMaterial& source, Material& material) {
    const float thickness = numberOr(source, {AI_MATKEY_VOLUME_THICKNESS_FACTOR}, 0.0f);
    if (thickness <= 0.0f) {
        if (material.transmission.x > 0.0f) material.more.y |= kMaterialThin;
        return;
    }
    // Infinite, which is "never", where the file has none.
    const float distance = numberOr(source, {AI_MATKEY_VOLUME_ATTENUATION_DISTANCE}, 0.0f);
    material.transmission.z = std::max(distance, 0.0f);
    const auto color = findColor(source, {AI_MATKEY_VOLUME_ATTENUATION_COLOR});
    if (color) material.attenuation = vec4(clampColor(*color, 1.0f), material.attenuation.w);
}

void readOpacity(const aiMaterial& source, const std::string& alphaMode, MaterialSource& result) {
    const float cutoff = numberOr(source, {AI_MATKEY_GLTF_ALPHACUTOFF}, 0.5f);
    const bool masked = alphaMode == "MASK" && cutoff > 0.0f; // with 0 all of it is there
    if (masked || alphaMode == "BLEND") {
        result.material.baseColor.a = share(numberOr(source, {AI_MATKEY_OPACITY}, 1.0f));
        if (masked) result.material.transmission.w = share(cutoff);
    } else if (auto& texture = textureOf(result, TextureUse::BaseColor)) {
        texture->alphaName.clear();
    }
}

void readGltf(const aiMaterial& source, const std::string& alphaMode, MaterialSource& result,
              std::vector<std::string>& lost) {
    Material& material = result.material;
    setOptics(material, 0.0f, numberOr(source, {AI_MATKEY_TRANSMISSION_FACTOR}, 0.0f),
              numberOr(source, {AI_MATKEY_REFRACTI}, kGlassIor));
    material.reflection.x = share(numberOr(source, {AI_MATKEY_METALLIC_FACTOR}, 1.0f));
    material.reflection.y = share(numberOr(source, {AI_MATKEY_ROUGHNESS_FACTOR}, 1.0f));
    material.reflection.z = 1.0f;
    if (const auto glossiness = findNumber(source, {AI_MATKEY_GLOSSINESS_FACTOR})) {
        material.reflection.x = 0.0f;
        material.reflection.y = share(1.0f - *glossiness);
        lost.emplace_back("specular colour");
    }
    readVolume(source, material);
    readOpacity(source, alphaMode, result);
    if (numberOr(source, {AI_MATKEY_CLEARCOAT_FACTOR}, 0.0f) > 0.0f) lost.emplace_back("clear coat");
    if (findColor(source, {AI_MATKEY_SHEEN_COLOR_FACTOR})) lost.emplace_back("sheen");
}

// Of what the reflective colour says where there is one: COLLADA and FBX often name a share of black.
float readReflectivity(const aiMaterial& source) {
    const vec4 color = findColor(source, {AI_MATKEY_COLOR_REFLECTIVE}).value_or(vec4(1.0f));
    return numberOr(source, {AI_MATKEY_REFLECTIVITY}, 0.0f) * std::max({color.r, color.g, color.b});
}

std::optional<float> firstNumber(const aiMaterial& source, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const auto number = findNumber(source, {name, 0, 0})) return number;
    return std::nullopt;
}

std::optional<vec4> firstColor(const aiMaterial& source, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const auto color = findColor(source, {name, 0, 0})) return color;
    return std::nullopt;
}

// FBX's physically based materials: Stingray's under Assimp's own keys, those of 3ds Max and Arnold as they
// stand in the file. Assimp makes a roughness of a highlight's exponent too: only metal tells. False for any
// other material.
bool readPbr(const aiMaterial& source, Material& material) {
    const auto metallic = firstNumber(source, {"$mat.metallicFactor", "$raw.3dsMax|Parameters|metalness",
                                               "$raw.3dsMax|main|metalness", "$raw.Maya|metalness"});
    if (!metallic) return false;
    const auto roughness =
        firstNumber(source, {"$raw.3dsMax|Parameters|roughness", "$raw.3dsMax|main|roughness",
                             "$raw.Maya|specularRoughness", "$mat.roughnessFactor"});
    const auto through =
        firstNumber(source, {"$raw.3dsMax|Parameters|transparency", "$raw.Maya|transmission"});
    const auto ior = firstNumber(source, {"$raw.3dsMax|Parameters|trans_ior", "$raw.Maya|specularIOR"});
    setOptics(material, 0.0f, through.value_or(1.0f - numberOr(source, {AI_MATKEY_OPACITY}, 1.0f)),
              ior.value_or(kGlassIor));
    material.reflection.x = share(*metallic);
    material.reflection.y = share(roughness.value_or(material.reflection.y));
    material.reflection.z = 1.0f;
    return true;
}

// Of the same kinds of materials, or what any other has.
vec4 readEmission(const aiMaterial& source, float usualStrength) {
    if (const auto color =
            firstColor(source, {"$raw.3dsMax|Parameters|emit_color", "$raw.Maya|emissionColor"}))
        return *color * firstNumber(source, {"$raw.3dsMax|Parameters|emission", "$raw.Maya|emission"})
                            .value_or(usualStrength);
    return findColor(source, {AI_MATKEY_COLOR_EMISSIVE}).value_or(vec4(0.0f)) *
           numberOr(source, {AI_MATKEY_EMISSIVE_INTENSITY}, usualStrength);
}

void readOptics(const aiMaterial& source, MaterialSource& result, std::vector<std::string>& lost) {
    if (const auto illum = findInteger(source, {AI_MATKEY_OBJ_ILLUM}))
        readMtlOptics(source, *illum, result.material);
    else if (const auto alphaMode = findText(source, {AI_MATKEY_GLTF_ALPHAMODE}))
        readGltf(source, *alphaMode, result, lost);
    else if (!readPbr(source, result.material))
        setOptics(result.material, readReflectivity(source),
                  1.0f - numberOr(source, {AI_MATKEY_OPACITY}, 1.0f),
                  numberOr(source, {AI_MATKEY_REFRACTI}, 1.0f));
}

// Also drops the textures of what is zero anyway.
void readFactorsOfTextures(const aiMaterial& source, float emissiveStrength, MaterialSource& result) {
    const vec3 emission =
        clampColor(readEmission(source, emissiveStrength), std::numeric_limits<float>::max());
    result.material.emission = vec4(emission, 0.0f);
    if (emission == vec3(0.0f)) textureOf(result, TextureUse::Emission).reset();
    if (result.material.transmission.x == 0.0f) textureOf(result, TextureUse::Transmission).reset();
    const auto& normals = textureOf(result, TextureUse::Normals);
    if (!normals) return;
    const aiTextureType type = normals->mayBeHeights ? aiTextureType_HEIGHT : aiTextureType_NORMALS;
    const float multiplier = numberOr(source, {AI_MATKEY_OBJ_BUMPMULT(type, 0)}, 1.0f);
    result.material.attenuation.w = numberOr(source, {AI_MATKEY_GLTF_TEXTURE_SCALE(type, 0)}, multiplier);
}

// Assimp makes materials up where a file has none: named so, or for PLY nameless and pure white.
bool isMadeUp(const std::string& name, const vec4& color, const aiMaterial& source) {
    const bool gltf = findText(source, {AI_MATKEY_GLTF_ALPHAMODE}).has_value();
    return name == AI_DEFAULT_MATERIAL_NAME || (name.empty() && !gltf && color == vec4(1.0f));
}

vec4 readBaseColor(const aiMaterial& source, const std::string& name, bool textured) {
    const bool glossy = findNumber(source, {AI_MATKEY_GLOSSINESS_FACTOR}).has_value();
    const auto diffuse = findColor(source, {AI_MATKEY_COLOR_DIFFUSE});
    const auto base = glossy ? std::nullopt
                             : firstColor(source, {"$clr.base", "$raw.3dsMax|Parameters|base_color",
                                                   "$raw.3dsMax|main|basecolor", "$raw.Maya|baseColor"});
    const vec4 color = base.value_or(diffuse.value_or(vec4(1.0f)));
    if (!textured && isMadeUp(name, color, source)) return vec4(vec3(kDefaultGrey), 1.0f);
    return vec4(clampColor(color, 1.0f), 1.0f);
}

} // namespace

MaterialSource readMaterial(const aiMaterial& source, const GltfMaterialExtras& extras,
                            std::vector<std::string>& warnings) {
    std::vector<std::string> lost = extras.lost;
    MaterialSource result{{}, diffuseMaterial(vec3(1.0f)), {}};
    result.name = findText(source, {AI_MATKEY_NAME}).value_or("");
    result.textures = readTextures(source, lost);
    result.material.baseColor =
        readBaseColor(source, result.name, textureOf(result, TextureUse::BaseColor).has_value());
    readOptics(source, result, lost);
    result.material.reflection.z *= extras.specular;
    readFactorsOfTextures(source, extras.emissiveStrength, result);
    if (findInteger(source, kGltfUnlit).value_or(0) != 0) keepBaseColorOnly(result);
    markClear(result);
    for (const TextureUse use : keepOneSetOfCoordinates(result.textures)) {
        lost.push_back(fmt::format("{} texture, which uses other texture coordinates,", nameOf(use)));
    }
    for (const std::string& what : lost)
        warnings.push_back(fmt::format("material '{}': its {} is not carried over", result.name, what));
    return result;
}

void keepBaseColorOnly(MaterialSource& source) {
    const vec4 baseColor = source.material.baseColor;
    const float cutoff = source.material.transmission.w;
    source.material = diffuseMaterial(vec3(1.0f));
    source.material.baseColor = baseColor;
    source.material.transmission.w = cutoff;
    source.material.more.y = kMaterialUnlit;
    for (unsigned use = 1; use < kTextureUses; ++use) source.textures[use].reset();
}

void markClear(MaterialSource& source) {
    const auto& colors = textureOf(source, TextureUse::BaseColor);
    const bool clear = source.material.baseColor.w < 1.0f || (colors && !colors->alphaName.empty());
    source.material.more.y =
        clear ? source.material.more.y | kMaterialClear : source.material.more.y & ~kMaterialClear;
}

} // namespace rt
