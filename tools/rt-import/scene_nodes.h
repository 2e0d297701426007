#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

struct aiNode;

namespace rt {

/// Product of the transforms of the node and those above it; the identity for none.
glm::dmat4 worldFromNode(const aiNode* node);

/// World position of a light or a camera of the node. Assimp gives some of them the node's own translation as
/// their position within the node too; it counts once.
glm::dvec3 worldPosition(const aiNode* node, const glm::dvec3& position);

} // namespace rt
