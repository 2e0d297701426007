#include "tools/rt-import/scene_nodes.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/scene.h>

namespace rt {

glm::dmat4 worldFromNode(const aiNode* node) {
    glm::dmat4 world(1.0);
    for (; node; node = node->mParent) world = mat4Of(node->mTransformation) * world;
    return world;
}

glm::dvec3 worldPosition(const aiNode* node, const aiNode* owner, const glm::dvec3& position) {
    const bool isTwice = owner && position == glm::dvec3(mat4Of(owner->mTransformation)[3]);
    return glm::dvec3(worldFromNode(node) * glm::dvec4(isTwice ? glm::dvec3(0.0) : position, 1.0));
}

std::vector<const aiNode*> nodesOf(const std::string& name, const NodesByName& known, const aiNode* root) {
    const auto found = known.find(name);
    return found != known.end() ? found->second : std::vector<const aiNode*>{root->FindNode(name.c_str())};
}

} // namespace rt
