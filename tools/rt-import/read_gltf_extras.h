#pragma once
#include "tools/rt-import/scene_nodes.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

struct aiScene;

namespace rt {

/// What a glTF material says and Assimp 5.2.5 does not pass on.
struct GltfMaterialExtras {
    float emissiveStrength = 1.0f;
    float specular = 1.0f;
    std::vector<std::string> lost; ///< what has no place in our material
};

struct GltfExtras {
    std::map<unsigned, GltfMaterialExtras> materials; ///< by the scene's index, where there is anything
    NodesByName lightNodes; ///< all nodes that show the light of this name; Assimp knows the last one only
    NodesByName cameraNodes;
};

/// Reads these from the JSON text of the file that `scene` was read from; nothing for files of other formats.
/// Extensions that are not read at all add a warning.
GltfExtras readGltfExtras(const std::string& path, const aiScene& scene, std::vector<std::string>& warnings);

} // namespace rt
