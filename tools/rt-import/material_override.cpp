#include "tools/rt-import/material_override.h"

#include "common/json_reader.h"
#include "tools/rt-import/model_folder.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

constexpr std::array<const char*, kTextureUses> kTextureKeys = {
    "baseColorTexture", "roughnessTexture", "normalTexture", "emissionTexture", "transmissionTexture"};

void readNumber(const JsonNode& json, const char* key, double low, double high, std::optional<float>& value) {
    if (const auto found = json.find(key)) value = static_cast<float>(found->number(low, high));
}

void readColor(const JsonNode& json, const char* key, double most, std::optional<vec3>& value) {
    if (const auto found = json.find(key)) value = found->color(most);
}

void readFlag(const JsonNode& json, const char* key, std::optional<bool>& value) {
    if (const auto found = json.find(key)) value = found->truth();
}

// A texture lies over the coordinates that the material's others use.
void setTexture(const std::string& path, TextureUse use, MaterialSource& material) {
    auto& texture = material.textures[static_cast<unsigned>(use)];
    if (path.empty()) {
        texture.reset();
        return;
    }
    TextureSource replacement;
    for (const auto& other : material.textures) {
        if (!other) continue;
        replacement.uvChannel = other->uvChannel;
        replacement.uvTransform = other->uvTransform;
    }
    replacement.name = path;
    replacement.isPath = true;
    if (use == TextureUse::BaseColor) replacement.alphaName = path;
    texture = replacement;
}

// `value` where there is one.
template <class T, class To>
void assign(const std::optional<T>& value, To& to) {
    if (value) to = *value;
}

void assignColor(const std::optional<vec3>& value, vec4& to) {
    if (value) to = vec4(*value, to.w);
}

void assignBit(const std::optional<bool>& value, std::uint32_t bit, std::uint32_t& bits) {
    if (value) bits = *value ? bits | bit : bits & ~bit;
}

} // namespace

MaterialOverride readOverride(const JsonNode& json, const ModelFolder& folder) {
    json.allow({"match",         "baseColor",        "opacity",
                "opacityCutoff", "metallic",         "roughness",
                "specular",      "mirror",           "transmission",
                "ior",           "attenuationColor", "attenuationDistance",
                "emission",      "normalScale",      "thin",
                "unlit",         "baseColorTexture", "roughnessTexture",
                "normalTexture", "emissionTexture",  "transmissionTexture"});
    MaterialOverride change;
    change.pattern = json.at("match").text();
    change.place = json.place();
    readColor(json, "baseColor", 1.0, change.baseColor);
    readColor(json, "emission", kMostFloat, change.emission);
    readColor(json, "attenuationColor", 1.0, change.attenuationColor);
    readNumber(json, "attenuationDistance", 0.0, kMostFloat, change.attenuationDistance);
    readNumber(json, "ior", 1.0, kMaxIor, change.ior);
    readNumber(json, "normalScale", -kMostFloat, kMostFloat, change.normalScale);
    readNumber(json, "opacity", 0.0, 1.0, change.opacity);
    readNumber(json, "opacityCutoff", 0.0, 1.0, change.opacityCutoff);
    readNumber(json, "metallic", 0.0, 1.0, change.metallic);
    readNumber(json, "roughness", 0.0, 1.0, change.roughness);
    readNumber(json, "specular", 0.0, 1.0, change.specular);
    readNumber(json, "mirror", 0.0, 1.0, change.mirror);
    readNumber(json, "transmission", 0.0, 1.0, change.transmission);
    readFlag(json, "thin", change.thin);
    readFlag(json, "unlit", change.unlit);
    for (unsigned use = 0; use < kTextureUses; ++use) {
        const auto texture = json.find(kTextureKeys[use]);
        if (texture) change.textures[use] = texture->isNull() ? "" : requireFile(*texture, folder);
    }
    return change;
}

// Goes back to the last * where the rest does not fit, never farther: no more than pattern times name steps.
bool matches(const std::string& pattern, const std::string& name) {
    std::size_t p = 0, n = 0;
    std::size_t star = std::string::npos, afterStar = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            afterStar = n;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
            ++p;
            ++n;
        } else if (star != std::string::npos) {
            p = star + 1;
            n = ++afterStar;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == std::string::npos;
}

void applyOverride(const MaterialOverride& change, MaterialSource& source) {
    Material& material = source.material;
    if (change.metallic || change.roughness || change.transmission || change.ior) {
        material.reflection.z = 1.0f;
        material.reflection.w = 0.0f;
        if (material.transmission.y == 1.0f) material.transmission.y = kGlassIor;
    }
    assignColor(change.baseColor, material.baseColor);
    assignColor(change.emission, material.emission);
    assignColor(change.attenuationColor, material.attenuation);
    assign(change.opacity, material.baseColor.w);
    assign(change.opacityCutoff, material.transmission.w);
    assign(change.metallic, material.reflection.x);
    assign(change.roughness, material.reflection.y);
    assign(change.specular, material.reflection.z);
    assign(change.mirror, material.reflection.w);
    assign(change.transmission, material.transmission.x);
    assign(change.ior, material.transmission.y);
    assign(change.attenuationDistance, material.transmission.z);
    assign(change.normalScale, material.attenuation.w);
    if (change.attenuationDistance)
        material.more.y &= ~kMaterialThin; // what takes colour out has a thickness
    assignBit(change.thin, kMaterialThin, material.more.y);
    assignBit(change.unlit, kMaterialUnlit, material.more.y);
    for (unsigned use = 0; use < kTextureUses; ++use)
        if (change.textures[use]) setTexture(*change.textures[use], static_cast<TextureUse>(use), source);
    if (change.unlit.value_or(false)) keepBaseColorOnly(source);
    markClear(source);
}

} // namespace rt
