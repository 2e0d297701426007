#include "tools/rt-import/correct_3ds.h"

#include "tools/rt-import/assimp_glm.h"

#include <assimp/camera.h>
#include <assimp/light.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

namespace rt {
namespace {

constexpr double kHalfFilmWidth = 18.0; // mm

glm::dvec3 across(const glm::dvec3& v, const glm::dvec3& unitAxis) {
    return v - unitAxis * glm::dot(v, unitAxis);
}

// The angle about the view by which +y was turned to `rolledY`; 0 for a view along y, which hides it.
double rollOf(const glm::dvec3& rolledY, const glm::dvec3& view) {
    const glm::dvec3 from = across({0, 1, 0}, view), to = across(rolledY, view);
    return std::atan2(glm::dot(glm::cross(from, to), view), glm::dot(from, to));
}

void correctCamera(aiCamera& camera) {
    const double lens = glm::degrees(static_cast<double>(camera.mHorizontalFOV));
    camera.mHorizontalFOV = static_cast<float>(2.0 * std::atan(kHalfFilmWidth / lens));
    const glm::dvec3 view = glm::normalize(glm::dvec3(vec3Of(camera.mLookAt)));
    const double roll = rollOf(glm::dvec3(vec3Of(camera.mUp)), view);
    const glm::dvec3 straight = across({0, 0, 1}, view);
    if (!(glm::length(straight) > 1e-6)) return; // straight up or down: +y is as good
    const glm::dvec3 up = straight * std::cos(roll) + glm::cross(view, straight) * std::sin(roll);
    camera.mUp = aiVector3D(static_cast<float>(up.x), static_cast<float>(up.y), static_cast<float>(up.z));
}

template <class T>
T numberAt(std::span<const std::byte> bytes, std::size_t at) {
    T number{};
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

// How many bytes stand before the chunks inside a chunk; nothing for one that has none, or none of interest.
std::optional<std::size_t> bytesBeforeChunks(std::uint16_t id, std::span<const std::byte> content) {
    switch (id) {
    case 0x4D4D: // the file
    case 0x3D3D: // the editor's part
    case 0x4100: // a mesh
        return 0;
    case 0x4000: // an object, after its name
        return static_cast<std::size_t>(std::ranges::find(content, std::byte(0)) - content.begin()) + 1;
    case 0x4120: // faces, four numbers of 16 bits each
        return content.size() < 2 ? 0 : 2 + std::size_t(8) * numberAt<std::uint16_t>(content, 0);
    default:
        return std::nullopt;
    }
}

// Whether any face is in a smoothing group.
bool hasSmoothingGroups(std::span<const std::byte> bytes) {
    constexpr std::size_t kHeader = 6;
    while (bytes.size() >= kHeader) {
        const auto id = numberAt<std::uint16_t>(bytes, 0);
        const std::size_t length =
            std::clamp<std::size_t>(numberAt<std::uint32_t>(bytes, 2), kHeader, bytes.size());
        const std::span<const std::byte> content = bytes.subspan(kHeader, length - kHeader);
        if (id == 0x4150 && std::ranges::any_of(content, [](std::byte b) { return b != std::byte(0); }))
            return true;
        const auto before = bytesBeforeChunks(id, content);
        if (before && *before < content.size() && hasSmoothingGroups(content.subspan(*before))) return true;
        bytes = bytes.subspan(length);
    }
    return false;
}

// Assimp gives each face vertices of its own. A face without area, which will be dropped, gets any normal.
void makeFlat(aiMesh& mesh) {
    for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
        const std::span<const unsigned> corners(face.mIndices, face.mNumIndices);
        if (corners.size() != 3 || std::ranges::max(corners) >= mesh.mNumVertices) continue;
        const glm::dvec3 a(vec3Of(mesh.mVertices[corners[0]])), b(vec3Of(mesh.mVertices[corners[1]])),
            c(vec3Of(mesh.mVertices[corners[2]]));
        const glm::dvec3 across = glm::cross(b - a, c - a);
        const double length = glm::length(across);
        const glm::vec3 normal = length > 0.0 ? glm::vec3(across / length) : glm::vec3(0.0f, 0.0f, 1.0f);
        for (const unsigned corner : corners) mesh.mNormals[corner] = {normal.x, normal.y, normal.z};
    }
}

} // namespace

void correct3ds(std::span<const std::byte> file, bool flat, aiScene& scene) {
    for (aiCamera* camera : std::span(scene.mCameras, scene.mNumCameras)) correctCamera(*camera);
    for (aiLight* light : std::span(scene.mLights, scene.mNumLights)) {
        light->mAttenuationConstant = 1.0f;
        light->mAttenuationLinear = light->mAttenuationQuadratic = 0.0f;
    }
    if (hasSmoothingGroups(file)) return;
    for (aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes)) {
        if (mesh->mNormals && flat) {
            makeFlat(*mesh);
            continue;
        }
        delete[] mesh->mNormals;
        mesh->mNormals = nullptr;
    }
}

} // namespace rt
