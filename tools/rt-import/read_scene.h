#pragma once
#include <glm/mat3x2.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

struct aiMesh;
struct aiScene;

namespace rt {

/// OpenMesh numbers halfedges, up to six for each triangle, with 32-bit integers.
inline constexpr std::uint64_t kMaxSoupCount = 1u << 28;

/// The triangles of a scene in file order, indexed as the file indexes them.
struct SceneSoup {
    std::vector<glm::vec3> positions; ///< world space, finite
    std::vector<glm::vec3> normals; ///< one per position, unit or 0 = none; empty if the file has none at all
    std::vector<glm::vec2> texcoords; ///< one per position; empty if not wanted
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> triangleMaterial; ///< one per triangle: index of the scene's material
    std::uint64_t droppedFaces = 0;              ///< points and lines
};

/// A mesh at one of its places in the node hierarchy.
struct MeshInstance {
    const aiMesh* mesh;
    glm::dmat4 worldFromMesh;
};

/// Meshes depth first through the nodes, a node's own meshes before its children's: the order of the
/// triangles. All of them for each of the model's `placements`, one after the other.
std::vector<MeshInstance> listInstances(const aiScene& scene, const std::vector<glm::dmat4>& placements);

/// For each of the scene's materials, whether any triangle uses it.
/// Throws Error{InvalidContent}, message prefixed by `path`, for a mesh whose material does not exist.
std::vector<bool> findUsedMaterials(const aiScene& scene, const std::vector<MeshInstance>& instances,
                                    const std::string& path);

/// What of a file's vertices is wanted.
struct SoupOptions {
    bool normals = true;
    bool texcoords = false;
    std::vector<std::uint32_t> uvChannel; ///< per material of the scene
    std::vector<glm::mat3x2> uvTransform; ///< the same; applied to (u, v, 1)
};

/// Places the instances in the world: positions by their transforms, normals by the inverse transpose,
/// corners 1 and 2 exchanged where the transform mirrors. Throws Error{InvalidContent} for indices that do
/// not exist and coordinates that are not finite before or after the transform, Error{LimitExceeded} for more
/// than 2^28 of anything; messages prefixed by `path`.
SceneSoup readSoup(const aiScene& scene, const std::vector<MeshInstance>& instances,
                   const SoupOptions& wanted, const std::string& path);

/// Throws Error{InvalidContent}, message prefixed by `path`, unless all positions and their extent are
/// finite.
void requireFiniteWorld(const SceneSoup& soup, const std::string& path);

} // namespace rt
