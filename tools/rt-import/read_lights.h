#pragma once
#include "formats/material.shared.h"
#include "tools/rt-import/scene_nodes.h"

struct aiScene;

namespace rt {

/// Whether a file states the angle from a spot's axis (glTF) or from one side of its cone to the other.
enum class SpotAngles { FromAxis, AcrossCone };

/// The scene's point, spot, directional and area lights in the model's space, at each of their nodes. The
/// colour of a point or spot is its radiant intensity, that of a directional light its irradiance, that of an
/// area its radiance. Where the file states no fall-off with distance (3DS), points and spots are scaled so
/// that a white surface at the distance of the scene's centre is lit as without. What is no such light or not
/// finite is counted in a warning.
std::vector<Light> readLights(const aiScene& scene, const NodesByName& nodes, const glm::vec3& sceneCentre,
                              SpotAngles spotAngles, std::vector<std::string>& warnings);

} // namespace rt
