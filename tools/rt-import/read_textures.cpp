#include "tools/rt-import/read_textures.h"

#include "tools/rt-import/material_property.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr const char* kUseNames[kTextureUses] = {"base colour", "roughness", "normal", "emission",
                                                 "transmission"};

// Textures of these kinds have no place in our material. Ambient occlusion and thickness, which
// rays find by themselves, are not missed.
constexpr std::pair<aiTextureType, const char*> kUnknownTextures[] = {
    {aiTextureType_SPECULAR, "specular texture"},     {aiTextureType_SHININESS, "shininess texture"},
    {aiTextureType_DISPLACEMENT, "displacement map"}, {aiTextureType_REFLECTION, "reflection map"},
    {aiTextureType_SHEEN, "sheen texture"},           {aiTextureType_CLEARCOAT, "clear coat texture"}};

// GetTextureCount() would not do: Assimp keeps glTF's thickness as the second of the transmission textures.
std::optional<std::string> findFile(const aiMaterial& source, aiTextureType type) {
    auto name = findText(source, {AI_MATKEY_TEXTURE(type, 0)});
    return name && !name->empty() ? name : std::nullopt;
}

std::uint32_t wrapOf(const aiMaterial& source, MaterialKey key) {
    switch (findInteger(source, key).value_or(aiTextureMapMode_Wrap)) {
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

bool isFinite(const glm::mat3x2& m) {
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(m[c].x) || !std::isfinite(m[c].y)) return false;
    return true;
}

// Assimp turns about the middle of the image and counts v upwards; its translation makes up for both. This
// takes that back, for glTF's rule: offset * rotation * scale of coordinates with v downwards.
// Source: KHR_texture_transform.
glm::mat3x2 gltfTransform(const aiUVTransform& t) {
    const float c = std::cos(t.mRotation), s = -std::sin(t.mRotation); // of glTF's angle, which is -mRotation
    const float sx = t.mScaling.x, sy = t.mScaling.y;
    const float offsetX = t.mTranslation.x - 0.5f * sx * (1.0f - c + s);
    const float offsetY = 0.5f * sy * (s + c - 1.0f) + 1.0f - sy - t.mTranslation.y;
    // u' = c sx u + s sy v + ox, v' = -s sx u + c sy v + oy; then v -> 1 - v on both sides.
    return {c * sx, s * sx, -s * sy, c * sy, s * sy + offsetX, 1.0f - c * sy - offsetY};
}

std::optional<TextureSource> findTexture(const aiMaterial& source, aiTextureType type,
                                         std::vector<std::string>& lost) {
    const auto name = findFile(source, type);
    if (!name) return std::nullopt;
    TextureSource texture;
    texture.name = *name;
    texture.wrapU = wrapOf(source, {AI_MATKEY_MAPPINGMODE_U(type, 0)});
    texture.wrapV = wrapOf(source, {AI_MATKEY_MAPPINGMODE_V(type, 0)});
    texture.uvChannel =
        static_cast<std::uint32_t>(std::max(0, findInteger(source, {AI_MATKEY_UVWSRC(type, 0)}).value_or(0)));
    aiUVTransform transform;
    if (source.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) != aiReturn_SUCCESS || isIdentity(transform))
        return texture;
    const bool gltf = findText(source, {AI_MATKEY_GLTF_ALPHAMODE}).has_value();
    const glm::mat3x2 ours = gltfTransform(transform);
    if (gltf && isFinite(ours))
        texture.uvTransform = ours;
    else
        lost.emplace_back("texture transform");
    return texture;
}

std::optional<TextureSource> findBaseColor(const aiMaterial& source, std::vector<std::string>& lost) {
    const bool glossy = findNumber(source, {AI_MATKEY_GLOSSINESS_FACTOR}).has_value();
    const auto type = findFile(source, aiTextureType_BASE_COLOR) && !glossy ? aiTextureType_BASE_COLOR
                                                                            : aiTextureType_DIFFUSE;
    auto texture = findTexture(source, type, lost);
    const auto alphaMode = findText(source, {AI_MATKEY_GLTF_ALPHAMODE});
    if (alphaMode) {
        if (texture && *alphaMode != "OPAQUE") texture->alphaName = texture->name;
        return texture;
    }
    const auto opacity = findTexture(source, aiTextureType_OPACITY, lost);
    if (!opacity) return texture;
    if (!texture) {
        texture = opacity;
        texture->name.clear();
    }
    texture->alphaName = opacity->name;
    return texture;
}

// A bump map is one of heights by its definition, but often holds normals.
std::optional<TextureSource> findNormals(const aiMaterial& source, std::vector<std::string>& lost) {
    for (const aiTextureType type : {aiTextureType_NORMALS, aiTextureType_NORMAL_CAMERA})
        if (auto texture = findTexture(source, type, lost)) return texture;
    auto texture = findTexture(source, aiTextureType_HEIGHT, lost);
    if (texture) texture->mayBeHeights = true;
    return texture;
}

} // namespace

const char* nameOf(TextureUse use) {
    return kUseNames[static_cast<unsigned>(use)];
}

TextureSources readTextures(const aiMaterial& source, std::vector<std::string>& lost) {
    const bool gltf = findText(source, {AI_MATKEY_GLTF_ALPHAMODE}).has_value();
    TextureSources textures{findBaseColor(source, lost), std::nullopt, findNormals(source, lost),
                            findTexture(source,
                                        findFile(source, aiTextureType_EMISSIVE)
                                            ? aiTextureType_EMISSIVE
                                            : aiTextureType_EMISSION_COLOR,
                                        lost),
                            findTexture(source, aiTextureType_TRANSMISSION, lost)};
    if (gltf)
        textures[1] = findTexture(source, aiTextureType_UNKNOWN, lost); // roughness in G, metallic in B
    else
        for (const auto& [type, name] : {std::pair(aiTextureType_DIFFUSE_ROUGHNESS, "roughness texture"),
                                         {aiTextureType_METALNESS, "metalness texture"}})
            if (findFile(source, type)) lost.emplace_back(name);
    for (const auto& [type, name] : kUnknownTextures)
        if (findFile(source, type)) lost.emplace_back(name);
    return textures;
}

std::vector<TextureUse> keepOneSetOfCoordinates(TextureSources& textures) {
    const auto first = std::find_if(textures.begin(), textures.end(),
                                    [](const auto& texture) { return texture.has_value(); });
    std::vector<TextureUse> removed;
    for (unsigned use = 0; use < kTextureUses; ++use) {
        auto& texture = textures[use];
        if (!texture ||
            (texture->uvChannel == (*first)->uvChannel && texture->uvTransform == (*first)->uvTransform))
            continue;
        texture.reset();
        removed.push_back(static_cast<TextureUse>(use));
    }
    return removed;
}

} // namespace rt
