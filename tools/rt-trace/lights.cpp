#include "tools/rt-trace/lights.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace rt {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Radiance of a white diffuse surface that faces the light.
constexpr double kKeyRadiance = 0.9;
constexpr double kFillRadiance = 0.25;

// A light in world space; its place and intensity stand here before they are rounded.
struct WorldLight {
    glm::dvec3 position;
    glm::dvec3 intensity;
    Light light;
};

// Intensity that gives a white diffuse surface at this distance, facing the light, a radiance of 1; of a
// rectangle as if it were small.
double intensityPerRadiance(const Light& light, double distance) {
    const double squared = distance * distance;
    if (light.kind.x == kLightDirectional) return kPi;
    if (light.kind.x == kLightRectangle) {
        const double area =
            4.0 * double(glm::length(glm::vec3(light.edgeU))) * double(glm::length(glm::vec3(light.edgeV)));
        return kPi * squared / area;
    }
    if (light.kind.x == kLightSphere)
        return std::max(1.0, squared / (double(light.position.w) * double(light.position.w)));
    return kPi * squared;
}

WorldLight whiteLight(const glm::dvec3& position, double radiance, double distance) {
    return {position, glm::dvec3(radiance * kPi * distance * distance), pointLight({}, {})};
}

// Radiance does not depend on the scale; intensity falls with the square of a distance, which does.
Light toAtlas(const WorldLight& world, const glm::dvec3& offset, double scale) {
    Light light = world.light;
    const auto s = static_cast<float>(scale);
    light.position = glm::vec4(glm::vec3((world.position - offset) * scale), light.position.w * s);
    const bool fallsOff = light.kind.x == kLightPoint || light.kind.x == kLightSpot;
    light.intensity = glm::vec4(glm::vec3(world.intensity * (fallsOff ? scale * scale : 1.0)), 0.0f);
    light.edgeU = glm::vec4(glm::vec3(light.edgeU) * s, light.edgeU.w);
    light.edgeV = glm::vec4(glm::vec3(light.edgeV) * s, light.edgeV.w);
    return light;
}

bool contains(const BoundsD& box, const glm::dvec3& point) {
    return glm::min(point, box.lo) == box.lo && glm::max(point, box.hi) == box.hi;
}

// Outside, the lights stand round the scene as seen from the camera; a camera within the scene, a room say,
// carries them, since the walls would hide them otherwise.
std::vector<WorldLight> defaultLights(const BoundsD& scene, const CameraPose& pose) {
    const CameraBasis basis = basisOf(pose, 1.0);
    const double radius = sceneRadius(scene);
    if (contains(scene, pose.eye)) {
        const double reach = 0.5 * radius;
        const glm::dvec3 shift = 0.05 * radius * (basis.up - basis.right);
        return {whiteLight(pose.eye + shift, kKeyRadiance, reach),
                whiteLight(pose.eye - shift, kFillRadiance, reach)};
    }
    const double distance = 2.5 * radius;
    const glm::dvec3 key = glm::normalize(-basis.forward + 0.9 * basis.up - 0.7 * basis.right);
    const glm::dvec3 fill = glm::normalize(-basis.forward + 0.2 * basis.up + 1.2 * basis.right);
    return {whiteLight(scene.centre() + key * distance, kKeyRadiance, distance),
            whiteLight(scene.centre() + fill * distance, kFillRadiance, distance)};
}

std::vector<WorldLight> worldLights(const std::vector<LightRequest>& requested, const Atlas& atlas,
                                    const BoundsD& scene, const CameraPose& pose, bool environment) {
    std::vector<WorldLight> lights;
    for (const LightRequest& light : requested) {
        // Not nearer than part of the scene's size, or a light at the centre would be dark.
        const double distance =
            std::max(glm::distance(light.position, scene.centre()), 0.25 * sceneRadius(scene));
        const glm::dvec3 usual(kKeyRadiance * intensityPerRadiance(light.shape, distance));
        lights.push_back(
            {light.position, light.intensity ? glm::dvec3(*light.intensity) : usual, light.shape});
    }
    if (lights.empty())
        for (const Light& light : atlas.lights)
            lights.push_back({glm::dvec3(light.position), glm::dvec3(light.intensity), light});
    return lights.empty() && !environment ? defaultLights(scene, pose) : lights;
}

} // namespace

std::vector<Light> chooseLights(const std::vector<LightRequest>& requested, const Atlas& atlas,
                                const BoundsD& scene, const CameraPose& pose, bool environment) {
    const glm::dvec3 offset(atlas.grid.worldOffset);
    const double scale = atlas.grid.worldOffset.w;
    std::vector<Light> lights;
    for (const WorldLight& light : worldLights(requested, atlas, scene, pose, environment))
        lights.push_back(toAtlas(light, offset, scale));
    return lights;
}

} // namespace rt
