#include "tools/rt-import/scene_nodes.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/scene.h>

namespace rt {

glm::dmat4 worldFromNode(const aiNode* node) {
    glm::dmat4 world(1.0);
    for (; node; node = node->mParent) world = mat4Of(node->mTransformation) * world;
    return world;
}

glm::dvec3 worldPosition(const aiNode* node, const glm::dvec3& position) {
    const bool isTwice = node && position == glm::dvec3(mat4Of(node->mTransformation)[3]);
    return glm::dvec3(worldFromNode(node) * glm::dvec4(isTwice ? glm::dvec3(0.0) : position, 1.0));
}

} // namespace rt
