#include "tools/rt-import/read_lights.h"

#include "formats/mesh.h"

#include "tools/rt-import/assimp_glm.h"
#include "tools/rt-import/place_scenery.h"

#include <assimp/light.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rt {
namespace {

bool hasPlace(const aiLight& light) {
    return light.mType == aiLightSource_POINT || light.mType == aiLightSource_SPOT;
}

// The part of a light's colour that arrives at a distance.
double attenuation(const aiLight& light, double distance) {
    const double falls = double(light.mAttenuationConstant) + double(light.mAttenuationLinear) * distance +
                         double(light.mAttenuationQuadratic) * distance * distance;
    return falls > 0.0 ? 1.0 / falls : 1.0;
}

bool fallsOtherwise(const aiLight& light) {
    return hasPlace(light) && (light.mAttenuationConstant != 0.0f || light.mAttenuationLinear != 0.0f ||
                               light.mAttenuationQuadratic == 0.0f);
}

// Our lights give a white surface intensity / (pi d^2), or over pi where there is no distance; this makes it
// the colour itself.
double brightness(const aiLight& light, double distance) {
    if (light.mType == aiLightSource_AREA) return 1.0;
    if (light.mType == aiLightSource_DIRECTIONAL) return glm::pi<double>();
    return glm::pi<double>() * distance * distance * attenuation(light, distance);
}

// Not finite for a direction of length 0, which isValid() refuses.
vec3 unitVector(const glm::dvec3& v) {
    return vec3(v / glm::length(v));
}

void setCone(const aiLight& source, SceneryStyle style, Light& light) {
    const float scale = style == SceneryStyle::Gltf ? 1.0f : 0.5f;
    const float outer = std::clamp(scale * source.mAngleOuterCone, 0.0f, glm::pi<float>());
    const float inner = std::clamp(scale * source.mAngleInnerCone, 0.0f, outer);
    light.direction.w = std::cos(outer);
    light.edgeU.w = std::max(std::cos(inner), light.direction.w);
}

void setRectangle(const aiLight& source, const glm::dmat3& linear, Light& light) {
    const glm::dvec3 normal(vec3Of(source.mDirection)), up(vec3Of(source.mUp));
    const glm::dvec3 across = glm::cross(normal, up);
    setRectangle(glm::normalize(across) * (0.5 * static_cast<double>(source.mSize.x)),
                 glm::normalize(glm::cross(across, normal)) * (0.5 * static_cast<double>(source.mSize.y)),
                 normal, linear, light);
}

std::optional<std::uint32_t> kindOf(const aiLight& light) {
    switch (light.mType) {
    case aiLightSource_POINT:
        return kLightPoint;
    case aiLightSource_DIRECTIONAL:
        return kLightDirectional;
    case aiLightSource_SPOT:
        return kLightSpot;
    case aiLightSource_AREA:
        return kLightRectangle;
    default:
        return std::nullopt;
    }
}

Light readLight(const aiLight& source, std::uint32_t kind, const aiNode* node, const aiNode* owner,
                const glm::vec3& sceneCentre, SceneryStyle style) {
    const glm::dmat3 linear(worldFromNode(node));
    Light light{};
    light.kind.x = kind;
    glm::dvec3 color(source.mColorDiffuse.r, source.mColorDiffuse.g, source.mColorDiffuse.b);
    const glm::dvec3 position = worldPosition(node, owner, glm::dvec3(vec3Of(source.mPosition)));
    if (kind != kLightDirectional) light.position = vec4(vec3(position), 0.0f);
    if (style == SceneryStyle::Classic)
        color *= brightness(source, glm::distance(glm::dvec3(sceneCentre), position));
    light.intensity = vec4(vec3(glm::max(color, 0.0)), 0.0f);
    if (kind == kLightDirectional || kind == kLightSpot)
        light.direction = vec4(unitVector(linear * glm::dvec3(vec3Of(source.mDirection))), 0.0f);
    if (kind == kLightSpot) setCone(source, style, light);
    if (kind == kLightRectangle) setRectangle(source, linear, light);
    return light;
}

} // namespace

std::vector<Light> readLights(const aiScene& scene, const NodesByName& nodes, const glm::vec3& sceneCentre,
                              SceneryStyle style, std::vector<std::string>& warnings) {
    std::vector<Light> lights;
    unsigned otherKinds = 0, otherFall = 0, broken = 0;
    for (unsigned i = 0; i < scene.mNumLights; ++i) {
        const aiLight& source = *scene.mLights[i];
        const auto kind = kindOf(source);
        otherKinds += !kind;
        if (!kind) continue;
        const aiNode* owner = scene.mRootNode->FindNode(source.mName);
        for (const aiNode* node : nodesOf(source.mName.C_Str(), nodes, scene.mRootNode)) {
            const Light light = readLight(source, *kind, node, owner, sceneCentre, style);
            const bool valid = isValid(light);
            if (valid) lights.push_back(light);
            broken += !valid;
            otherFall += valid && style == SceneryStyle::Classic && fallsOtherwise(source);
        }
    }
    if (otherKinds > 0)
        warnings.push_back(fmt::format(
            "{} lights are neither points, spots, directional nor areas and are left out", otherKinds));
    if (broken > 0)
        warnings.push_back(
            fmt::format("{} lights are not finite or have no direction or size and are left out", broken));
    if (otherFall > 0)
        warnings.push_back(
            fmt::format("{} lights do not fall off with the square of the distance in the file; they "
                        "do here, and keep their brightness at the scene's centre",
                        otherFall));
    return lights;
}

} // namespace rt
