#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <map>
#include <string>
#include <vector>

struct aiNode;

namespace rt {

/// How a file states its lights and cameras. glTF: candela and lux, a spot's angles from its axis, a camera's
/// angle of the height times the ratio of the sides (which is what Assimp makes of it). Others: the colour
/// that a white surface shows in that light, which falls off as the file says; a spot's angles from one side
/// to the other; a camera's angle of the width, or of the height where no ratio is given.
enum class SceneryStyle { Gltf, Classic };

/// The nodes at which a light or camera of this name stands.
using NodesByName = std::map<std::string, std::vector<const aiNode*>>;

/// Those of `name`, or else the one below `root` that is called so; a null pointer, the world itself, if
/// there is none.
std::vector<const aiNode*> nodesOf(const std::string& name, const NodesByName& known, const aiNode* root);

/// Product of the transforms of the node and those above it; the identity for none.
glm::dmat4 worldFromNode(const aiNode* node);

/// World position of a light or a camera of the node. Assimp gives some of them the translation of one of
/// their nodes, `owner`, as their position within the node too; it counts once.
glm::dvec3 worldPosition(const aiNode* node, const aiNode* owner, const glm::dvec3& position);

} // namespace rt
