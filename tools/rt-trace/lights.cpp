#include "tools/rt-trace/lights.h"

#include "formats/mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace rt {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Radiance of a white diffuse surface that faces the light.
constexpr double kKeyRadiance = 0.9;
constexpr double kFillRadiance = 0.25;

struct WorldLight {
    glm::dvec3 position;
    glm::dvec3 intensity;
};

WorldLight whiteLight(const glm::dvec3& position, double radiance, double distance) {
    return {position, glm::dvec3(radiance * kPi * distance * distance)};
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
                                    const BoundsD& scene, const CameraPose& pose) {
    std::vector<WorldLight> lights;
    for (const LightRequest& light : requested) {
        // Not nearer than part of the scene's size, or a light at the centre would be dark.
        const double distance =
            std::max(glm::distance(light.position, scene.centre()), 0.25 * sceneRadius(scene));
        lights.push_back(whiteLight(light.position, kKeyRadiance, distance));
        if (light.intensity) lights.back().intensity = glm::dvec3(*light.intensity);
    }
    if (lights.empty())
        for (const Light& light : atlas.lights)
            lights.push_back({glm::dvec3(light.position), glm::dvec3(light.intensity)});
    return lights.empty() ? defaultLights(scene, pose) : lights;
}

} // namespace

std::vector<Light> chooseLights(const std::vector<LightRequest>& requested, const Atlas& atlas,
                                const BoundsD& scene, const CameraPose& pose) {
    const glm::dvec3 offset(atlas.grid.worldOffset);
    const double scale = atlas.grid.worldOffset.w;
    std::vector<Light> lights;
    for (const WorldLight& light : worldLights(requested, atlas, scene, pose))
        lights.push_back(pointLight(glm::vec3((light.position - offset) * scale),
                                    glm::vec3(light.intensity * (scale * scale))));
    return lights;
}

} // namespace rt
