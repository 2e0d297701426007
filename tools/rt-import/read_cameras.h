#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/scene_nodes.h"

struct aiScene;

namespace rt {

/// The scene's cameras in world space, one for each of their nodes, under the names of their nodes: clipped
/// to 63 bytes where a character ends, control characters replaced, ".1", ".2" and so on behind a name that
/// was there before. A camera that is not finite adds a warning and is left out.
std::vector<NamedCamera> readCameras(const aiScene& scene, const NodesByName& nodes,
                                     std::vector<std::string>& warnings);

} // namespace rt
