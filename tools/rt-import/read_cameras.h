#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/scene_nodes.h"

struct aiScene;

namespace rt {

/// The scene's cameras in the model's space, one for each of their nodes, under the names of their nodes:
/// clipped to 63 bytes where a character ends, control characters replaced. A camera that is not finite adds
/// a warning and is left out.
std::vector<NamedCamera> readCameras(const aiScene& scene, const NodesByName& nodes, SceneryStyle style,
                                     std::vector<std::string>& warnings);

/// Puts ".1", ".2" and so on behind names that were there before.
void makeNamesUnique(std::vector<NamedCamera>& cameras);

} // namespace rt
