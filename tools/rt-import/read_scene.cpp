#include "tools/rt-import/read_scene.h"

#include "common/bounds.h"
#include "common/error.h"
#include "tools/rt-import/assimp_glm.h"
#include "tools/rt-import/open_model.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace rt {
namespace {

bool isFinite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isFinite(const glm::vec2& v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}

std::uint64_t countTriangles(const aiMesh& mesh) {
    std::uint64_t count = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) count += mesh.mFaces[f].mNumIndices == 3;
    return count;
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
    soup.origins.reserve(triangles);
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
        soup.texcoords.push_back(options.uvTransform[mesh.mMaterialIndex] * glm::vec3(t.x, t.y, 1.0f));
    }
}

// What keeps a face out of the soup.
std::optional<Defect> faultOf(const aiFace& face, const aiMesh& mesh, std::uint32_t firstVertex,
                              const SceneSoup& soup) {
    if (face.mNumIndices == 0) return Defect::MissingVertices; // a polygon that lost its corners for that
    if (face.mNumIndices != 3) return Defect::PointsAndLines;
    const std::span<const unsigned> corners(face.mIndices, 3);
    if (std::any_of(corners.begin(), corners.end(), [&](unsigned c) { return c >= mesh.mNumVertices; }))
        return Defect::MissingVertices;
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](unsigned c) { return isFinite(soup.positions[firstVertex + c]); }))
        return Defect::NotFinite;
    return std::nullopt;
}

void noteBadAttributes(const aiMesh& mesh, const glm::uvec3& t, FaceOrigin origin, const SceneSoup& soup,
                       Ledger& ledger) {
    const auto anyCorner = [&](const auto& is) { return is(t.x) || is(t.y) || is(t.z); };
    if (mesh.HasNormals() && !soup.normals.empty() &&
        anyCorner([&](std::uint32_t v) { return soup.normals[v] == glm::vec3(0.0f); }))
        ledger.add(Defect::BadNormals, origin);
    if (!soup.texcoords.empty() && anyCorner([&](std::uint32_t v) { return !isFinite(soup.texcoords[v]); }))
        ledger.add(Defect::BadTexcoords, origin);
}

void appendTriangles(const MeshInstance& instance, bool mirrored, std::uint32_t firstVertex,
                     const std::vector<std::uint32_t>& polygonOf, std::uint32_t meshId, Ledger& ledger,
                     SceneSoup& soup) {
    const aiMesh& mesh = *instance.mesh;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        const FaceOrigin origin{meshId, polygonOf.empty() ? f : polygonOf[f]};
        if (const auto fault = faultOf(face, mesh, firstVertex, soup)) {
            ledger.add(*fault, origin);
            continue;
        }
        const glm::uvec3 t(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
        soup.triangles.push_back(firstVertex + (mirrored ? glm::uvec3(t.x, t.z, t.y) : t));
        soup.triangleMaterial.push_back(mesh.mMaterialIndex);
        soup.origins.push_back(origin);
        noteBadAttributes(mesh, soup.triangles.back(), origin, soup, ledger);
    }
}

void appendInstance(const OpenModel& model, const MeshInstance& instance, const SoupOptions& options,
                    std::uint32_t meshId, Ledger& ledger, SceneSoup& soup) {
    const glm::dmat3 linear(instance.worldFromMesh);
    const double determinant = glm::determinant(linear);
    const auto firstVertex = static_cast<std::uint32_t>(soup.positions.size());
    if (countTriangles(*instance.mesh) > 0)
        appendVertices(instance, normalTransform(linear, determinant), options, soup);
    appendTriangles(instance, determinant < 0.0, firstVertex, model.polygonsOf(instance.meshIndex), meshId,
                    ledger, soup);
    for (std::size_t v = firstVertex; v < soup.texcoords.size(); ++v)
        if (!isFinite(soup.texcoords[v])) soup.texcoords[v] = glm::vec2(0.0f);
    for (const std::uint32_t polygon : model.badPolygonsOf(instance.meshIndex))
        ledger.add(Defect::BadPolygons, {meshId, polygon});
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
            instances.push_back({top.node->mMeshes[m], scene.mMeshes[top.node->mMeshes[m]], worldFromNode});
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

SceneSoup readSoup(const OpenModel& model, const std::vector<MeshInstance>& instances,
                   const SoupOptions& wanted, const std::string& path, Ledger& ledger) {
    const aiScene& scene = model.scene();
    SoupOptions options = wanted;
    options.normals = wanted.normals && anyHasNormals(instances);
    SceneSoup soup;
    reserve(soup, instances, options, path);
    std::uint32_t firstMesh = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const std::uint32_t id = ledger.addMesh(scene.mMeshes[m]->mName.C_Str());
        if (m == 0) firstMesh = id;
    }
    for (const MeshInstance& instance : instances)
        appendInstance(model, instance, options, firstMesh + instance.meshIndex, ledger, soup);
    return soup;
}

void removeTriangles(SceneSoup& soup, const std::vector<bool>& dropped) {
    removeMarked(soup.triangles, dropped);
    removeMarked(soup.triangleMaterial, dropped);
    removeMarked(soup.origins, dropped);
}

void requireFiniteExtent(const SceneSoup& soup, const std::string& path) {
    Bounds bounds;
    for (const glm::uvec3& t : soup.triangles)
        for (int corner = 0; corner < 3; ++corner) bounds.add(soup.positions[t[corner]]);
    if (!isFinite(bounds.extent()))
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: the scene reaches from {:g} to {:g}, an extent that "
                                "overflows 32 bits; scale it to smaller coordinates",
                                path, glm::min(bounds.lo.x, glm::min(bounds.lo.y, bounds.lo.z)),
                                glm::max(bounds.hi.x, glm::max(bounds.hi.y, bounds.hi.z))));
}

void requireTriangles(const SceneSoup& soup, const std::string& path, const Ledger& ledger) {
    if (!soup.triangles.empty()) return;
    const std::vector<std::string> lines = ledger.lines();
    throw Error(ErrorKind::InvalidContent,
                fmt::format("{}: has no triangles{}; nothing could be seen", path,
                            lines.empty() ? "" : fmt::format(" ({})", fmt::join(lines, "; "))));
}

} // namespace rt
