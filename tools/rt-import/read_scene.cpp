#include "tools/rt-import/read_scene.h"

#include "common/bounds.h"
#include "common/error.h"
#include "tools/rt-import/assimp_glm.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

bool isFinite(const aiVector3D& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isFinite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::uint64_t countTriangles(const aiMesh& mesh) {
    std::uint64_t count = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) count += mesh.mFaces[f].mNumIndices == 3;
    return count;
}

void requireFinite(const aiScene& scene, const std::string& path) {
    std::uint64_t bad = 0;
    std::string first;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[m];
        if (countTriangles(mesh) == 0) continue;
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& p = mesh.mVertices[v];
            if (isFinite(p)) continue;
            if (bad++ == 0)
                first = fmt::format("vertex {} of mesh '{}' is ({}, {}, {})", v, mesh.mName.C_Str(), p.x, p.y,
                                    p.z);
        }
    }
    if (bad > 0)
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: {}; {} vertices are not finite; correct or remove them", path, first, bad));
}

bool anyHasNormals(const std::vector<MeshInstance>& instances) {
    return std::any_of(instances.begin(), instances.end(), [](const MeshInstance& instance) {
        return instance.mesh->HasNormals() && countTriangles(*instance.mesh) > 0;
    });
}

// Sizes everything beforehand, so that a file of few bytes and many instances fails before it takes the
// memory.
void reserve(SceneSoup& soup, const std::vector<MeshInstance>& instances, const SoupOptions& options,
             const std::string& path) {
    std::uint64_t vertices = 0, triangles = 0;
    for (const MeshInstance& instance : instances) {
        const std::uint64_t count = countTriangles(*instance.mesh);
        soup.droppedFaces += instance.mesh->mNumFaces - count;
        if (count == 0) continue;
        triangles += count;
        vertices += instance.mesh->mNumVertices;
    }
    if (triangles > kMaxSoupCount || vertices > kMaxSoupCount)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} triangles and {} vertices exceed {}; split the scene", path,
                                triangles, vertices, kMaxSoupCount));
    soup.positions.reserve(vertices);
    if (options.normals) soup.normals.reserve(vertices);
    if (options.texcoords) soup.texcoords.reserve(vertices);
    soup.triangles.reserve(triangles);
    soup.triangleMaterial.reserve(triangles);
}

// Cofactors are the inverse transpose times the determinant, and exist for flattening transforms too.
glm::dmat3 normalTransform(const glm::dmat3& m, double determinant) {
    const double sign = determinant < 0.0 ? -1.0 : 1.0;
    return {sign * glm::cross(m[1], m[2]), sign * glm::cross(m[2], m[0]), sign * glm::cross(m[0], m[1])};
}

glm::vec3 unitOrZero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return std::isnormal(length) ? glm::vec3(v / length) : glm::vec3(0.0f);
}

void appendVertices(const MeshInstance& instance, const glm::dmat3& worldFromNormal,
                    const SoupOptions& options, SceneSoup& soup) {
    const aiMesh& mesh = *instance.mesh;
    const unsigned channel = options.texcoords ? options.uvChannel[mesh.mMaterialIndex] : 0u;
    const bool hasTexcoords = options.texcoords && mesh.HasTextureCoords(channel);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const glm::dvec4 p(vec3Of(mesh.mVertices[v]), 1.0);
        soup.positions.push_back(glm::vec3(instance.worldFromMesh * p));
        if (options.normals)
            soup.normals.push_back(mesh.HasNormals()
                                       ? unitOrZero(worldFromNormal * glm::dvec3(vec3Of(mesh.mNormals[v])))
                                       : glm::vec3(0.0f));
        if (!options.texcoords) continue;
        const aiVector3D t = hasTexcoords ? mesh.mTextureCoords[channel][v] : aiVector3D(0, 0, 0);
        const glm::vec2 moved = options.uvTransform[mesh.mMaterialIndex] * glm::vec3(t.x, t.y, 1.0f);
        soup.texcoords.push_back(isFinite(glm::vec3(moved, 0.0f)) ? moved : glm::vec2(0.0f));
    }
}

void appendTriangles(const aiMesh& mesh, bool mirrored, std::uint32_t firstVertex, const std::string& path,
                     SceneSoup& soup) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices != 3) continue;
        const glm::uvec3 t(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
        if (t.x >= mesh.mNumVertices || t.y >= mesh.mNumVertices || t.z >= mesh.mNumVertices)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: face {} of mesh '{}' uses vertices {}, {}, {}; the mesh has {}",
                                    path, f, mesh.mName.C_Str(), t.x, t.y, t.z, mesh.mNumVertices));
        soup.triangles.push_back(firstVertex + (mirrored ? glm::uvec3(t.x, t.z, t.y) : t));
        soup.triangleMaterial.push_back(mesh.mMaterialIndex);
    }
}

} // namespace

std::vector<MeshInstance> listInstances(const aiScene& scene, const std::vector<glm::dmat4>& placements) {
    struct Pending {
        const aiNode* node;
        glm::dmat4 worldFromParent;
    };
    std::vector<MeshInstance> instances;
    std::vector<Pending> stack;
    for (auto placement = placements.rbegin(); placement != placements.rend(); ++placement)
        stack.push_back({scene.mRootNode, *placement});
    while (!stack.empty()) {
        const Pending top = stack.back();
        stack.pop_back();
        const glm::dmat4 worldFromNode = top.worldFromParent * mat4Of(top.node->mTransformation);
        for (unsigned m = 0; m < top.node->mNumMeshes; ++m)
            instances.push_back({scene.mMeshes[top.node->mMeshes[m]], worldFromNode});
        for (unsigned c = top.node->mNumChildren; c-- > 0;)
            stack.push_back({top.node->mChildren[c], worldFromNode});
    }
    return instances;
}

std::vector<bool> findUsedMaterials(const aiScene& scene, const std::vector<MeshInstance>& instances,
                                    const std::string& path) {
    std::vector<bool> used(scene.mNumMaterials, false);
    for (const MeshInstance& instance : instances) {
        const unsigned material = instance.mesh->mMaterialIndex;
        if (material >= scene.mNumMaterials)
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: mesh '{}' uses material {} of {}", path,
                                    instance.mesh->mName.C_Str(), material, scene.mNumMaterials));
        if (!used[material]) used[material] = countTriangles(*instance.mesh) > 0;
    }
    return used;
}

SceneSoup readSoup(const aiScene& scene, const std::vector<MeshInstance>& instances,
                   const SoupOptions& wanted, const std::string& path) {
    SoupOptions options = wanted;
    options.normals = wanted.normals && anyHasNormals(instances);
    SceneSoup soup;
    reserve(soup, instances, options, path);
    requireFinite(scene, path);
    for (const MeshInstance& instance : instances) {
        if (countTriangles(*instance.mesh) == 0) continue;
        const glm::dmat3 linear(instance.worldFromMesh);
        const double determinant = glm::determinant(linear);
        const auto firstVertex = static_cast<std::uint32_t>(soup.positions.size());
        appendVertices(instance, normalTransform(linear, determinant), options, soup);
        appendTriangles(*instance.mesh, determinant < 0.0, firstVertex, path, soup);
    }
    requireFiniteWorld(soup, path);
    return soup;
}

void requireFiniteWorld(const SceneSoup& soup, const std::string& path) {
    Bounds bounds;
    for (std::size_t v = 0; v < soup.positions.size(); ++v) {
        const glm::vec3& p = soup.positions[v];
        if (!isFinite(p))
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: vertex {} is ({}, {}, {}) after its node's transform; "
                                    "scale the scene to smaller coordinates",
                                    path, v, p.x, p.y, p.z));
        bounds.add(p);
    }
    if (!soup.positions.empty() && !isFinite(bounds.extent()))
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: the scene reaches from {:g} to {:g}, an extent that "
                                "overflows 32 bits; scale it to smaller coordinates",
                                path, glm::min(bounds.lo.x, glm::min(bounds.lo.y, bounds.lo.z)),
                                glm::max(bounds.hi.x, glm::max(bounds.hi.y, bounds.hi.z))));
}

} // namespace rt
