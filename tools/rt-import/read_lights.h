#pragma once
#include "formats/material.shared.h"

#include <string>
#include <vector>

struct aiScene;

namespace rt {

/// The scene's point lights in world space. A light's colour is its radiant intensity; where the file states
/// no fall-off with distance (3DS), it is scaled so that a white surface at the distance of the scene's
/// centre is lit as without. Other kinds of lights are counted in a warning.
std::vector<Light> readPointLights(const aiScene& scene, const glm::vec3& sceneCentre,
                                   std::vector<std::string>& warnings);

} // namespace rt
