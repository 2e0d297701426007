#pragma once
#include "formats/material.shared.h"
#include "tools/rt-import/scene_nodes.h"

struct aiScene;

namespace rt {

/// The scene's point, spot, directional and area lights in the model's space, at each of their nodes. What a
/// file of the classic style says of brightness and fall-off is met at `sceneCentre`; a fall-off other than
/// with the square of the distance, and what is no such light or not finite, is counted in a warning. An
/// area's colour is its radiance.
std::vector<Light> readLights(const aiScene& scene, const NodesByName& nodes, const glm::vec3& sceneCentre,
                              SceneryStyle style, std::vector<std::string>& warnings);

} // namespace rt
