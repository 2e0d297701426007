#pragma once
#include "tools/rt-import/ledger.h"

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

class OpenModel;

/// The most triangles, and vertices, that are read: OpenMesh numbers halfedges, up to six for each triangle,
/// with 32-bit integers.
inline constexpr std::uint64_t kMaxSoupCount = 1u << 28;

/// The triangles of a scene in file order, indexed as the file indexes them.
struct SceneSoup {
    std::vector<glm::vec3> positions; ///< world space, finite
    std::vector<glm::vec3> normals; ///< one per position, unit or 0 = none; empty if the file has none at all
    std::vector<glm::vec2> texcoords; ///< one per position; empty if not wanted
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint32_t> triangleMaterial; ///< one per triangle: index of the scene's material
    std::vector<FaceOrigin> origins;             ///< one per triangle
};

/// Takes away the values that `dropped`, of the same size, marks; the others keep their order.
template <class T>
void removeMarked(std::vector<T>& values, const std::vector<bool>& dropped) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!dropped[i]) values[kept++] = values[i];
    values.resize(kept);
}

/// Takes away the triangles that `dropped`, one per triangle, marks; the others keep their order.
void removeTriangles(SceneSoup& soup, const std::vector<bool>& dropped);

/// A mesh at one of its places in the node hierarchy.
struct MeshInstance {
    unsigned meshIndex;
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
/// corners 1 and 2 exchanged where the transform mirrors. Points, lines and faces that use vertices
/// which do not exist or are not finite, before or after the transform, are dropped and entered in `ledger`.
/// Throws Error{LimitExceeded}, message prefixed by `path`, for more than 2^28 of anything.
SceneSoup readSoup(const OpenModel& model, const std::vector<MeshInstance>& instances,
                   const SoupOptions& wanted, const std::string& path, Ledger& ledger);

/// Throws Error{InvalidContent}, prefixed by `path`, for a scene too wide for 32-bit floats.
void requireFiniteExtent(const SceneSoup& soup, const std::string& path);

/// Throws Error{InvalidContent}, prefixed by `path`, if there are no triangles, and says why if `ledger`
/// knows.
void requireTriangles(const SceneSoup& soup, const std::string& path, const Ledger& ledger);

} // namespace rt
