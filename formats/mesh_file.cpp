#include "formats/mesh_file.h"

#include "common/error.h"
#include "formats/parallel_check.h"
#include "formats/section_file.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

constexpr std::uint32_t kPositions = sectionId("POSI");
constexpr std::uint32_t kNormals = sectionId("NORM");
constexpr std::uint32_t kTexcoords = sectionId("TEXC");
constexpr std::uint32_t kTriangles = sectionId("TRIS");
constexpr std::uint32_t kTriangleMaterial = sectionId("TMAT");
constexpr std::uint32_t kMaterials = sectionId("MATL");
constexpr std::uint32_t kLights = sectionId("LITE");
constexpr std::uint32_t kCameras = sectionId("CAMS");
constexpr std::uint32_t kImages = sectionId("IMGS");
constexpr std::uint32_t kPixels = sectionId("PIXL");
constexpr std::uint32_t kCameraKeys = sectionId("PATH");
constexpr std::uint32_t kSurroundings = sectionId("SURR");
constexpr std::uint32_t kEnvironment = sectionId("ENVP");

void requireCount(std::size_t found, std::size_t wanted, const std::string& file, const char* what) {
    if (found != wanted)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: {} {} where {} were expected", file, found, what, wanted));
}

bool finite(const glm::vec2& v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}
bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isUnit(const glm::vec3& n) {
    return std::abs(glm::dot(n, n) - 1.0f) < 1e-3f;
} // false for NaN

bool isValidImage(const MeshImage& image, std::size_t pixelCount) {
    const std::uint64_t pixels = std::uint64_t(image.width) * image.height;
    return image.width > 0 && image.height > 0 && image.wrapU <= kWrapMirror && image.wrapV <= kWrapMirror &&
           image.space <= kImageLinear && image.zero == 0 && image.firstPixel <= pixelCount &&
           pixels <= pixelCount - image.firstPixel;
}

} // namespace

Bounds boundsOf(const Mesh& mesh) {
    Bounds bounds;
    for (const glm::uvec3& t : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) bounds.add(mesh.positions[t[corner]]);
    return bounds;
}

void validate(const Mesh& mesh, const std::string& name) {
    if (mesh.triangles.empty()) throw Error(ErrorKind::InvalidContent, name + ": has no triangles");
    if (mesh.triangles.size() > kMaxIndexedCount || mesh.positions.size() > kMaxIndexedCount)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} triangles and {} vertices exceed {}", name, mesh.triangles.size(),
                                mesh.positions.size(), kMaxIndexedCount));
    const std::size_t vertexCount = mesh.positions.size();
    requireCount(mesh.normals.size(), vertexCount, name, "normals");
    if (!mesh.texcoords.empty())
        requireCount(mesh.texcoords.size(), vertexCount, name, "texture coordinates");
    requireCount(mesh.triangleMaterial.size(), mesh.triangles.size(), name, "triangle materials");
    requireEach<glm::vec3>(mesh.positions, name, "position", [](const glm::vec3& p) { return finite(p); });
    requireEach<glm::vec3>(mesh.normals, name, "normal", isUnit);
    requireEach<glm::vec2>(mesh.texcoords, name, "texture coordinate",
                           [](const glm::vec2& t) { return finite(t); });
    requireEach<glm::uvec3>(mesh.triangles, name, "triangle", [=](const glm::uvec3& t) {
        return t.x < vertexCount && t.y < vertexCount && t.z < vertexCount;
    });
    requireEach<std::uint32_t>(mesh.triangleMaterial, name, "material of triangle",
                               [&](std::uint32_t m) { return m < mesh.materials.size(); });
    requireEach<MeshImage>(mesh.images, name, "image",
                           [&](const MeshImage& i) { return isValidImage(i, mesh.pixels.size()); });
    requireEach<Material>(mesh.materials, name, "material",
                          [&](const Material& m) { return isValid(m, mesh.images.size()); });
    requireEach<Light>(mesh.lights, name, "light", [](const Light& l) { return isValid(l); });
    requireEach<NamedCamera>(mesh.cameras, name, "camera", [](const NamedCamera& c) { return isValid(c); });
    if (!haveUniqueNames(mesh.cameras))
        throw Error(ErrorKind::InvalidContent, name + ": two cameras have one name");
    if (!areValid(mesh.cameraKeys, mesh.cameras.size()))
        throw Error(ErrorKind::InvalidContent, name + ": a camera's path is out of range or order");
    if (!areValid(mesh.surroundings, mesh.environment.size()))
        throw Error(ErrorKind::InvalidContent, name + ": background or environment out of range");
    requireEach<glm::vec3>(mesh.environment, name, "environment pixel", isLight);
}

void writeMesh(const std::string& path, const Mesh& mesh, const Recipe& recipe,
               const std::vector<OutputFile>& beside) {
    SectionFileWriter writer(kMeshKind);
    writer.add<glm::vec3>(kPositions, mesh.positions);
    writer.add<glm::vec3>(kNormals, mesh.normals);
    if (!mesh.texcoords.empty()) writer.add<glm::vec2>(kTexcoords, mesh.texcoords);
    writer.add<glm::uvec3>(kTriangles, mesh.triangles);
    writer.add<std::uint32_t>(kTriangleMaterial, mesh.triangleMaterial);
    writer.add<Material>(kMaterials, mesh.materials);
    if (!mesh.lights.empty()) writer.add<Light>(kLights, mesh.lights);
    if (!mesh.cameras.empty()) writer.add<NamedCamera>(kCameras, mesh.cameras);
    if (!mesh.images.empty()) {
        writer.add<MeshImage>(kImages, mesh.images);
        writer.add<std::uint32_t>(kPixels, mesh.pixels);
    }
    if (!mesh.cameraKeys.empty()) writer.add<CameraKey>(kCameraKeys, mesh.cameraKeys);
    if (!mesh.surroundings.empty()) writer.add<Surroundings>(kSurroundings, mesh.surroundings);
    if (!mesh.environment.empty()) writer.add<glm::vec3>(kEnvironment, mesh.environment);
    writer.addRecipe(recipe.text());
    writer.write(path, beside);
}

MeshFile readMesh(const std::string& path, const std::string& shownAs) {
    const SectionFile file(path, kMeshKind, shownAs);
    Mesh mesh;
    mesh.positions = file.get<glm::vec3>(kPositions);
    mesh.normals = file.get<glm::vec3>(kNormals);
    mesh.texcoords = file.get<glm::vec2>(kTexcoords);
    mesh.triangles = file.get<glm::uvec3>(kTriangles);
    mesh.triangleMaterial = file.get<std::uint32_t>(kTriangleMaterial);
    mesh.materials = file.get<Material>(kMaterials);
    mesh.lights = file.get<Light>(kLights);
    mesh.cameras = file.get<NamedCamera>(kCameras);
    mesh.images = file.get<MeshImage>(kImages);
    mesh.pixels = file.get<std::uint32_t>(kPixels);
    mesh.cameraKeys = file.get<CameraKey>(kCameraKeys);
    mesh.surroundings = file.get<Surroundings>(kSurroundings);
    mesh.environment = file.get<glm::vec3>(kEnvironment);
    file.verify([&] { validate(mesh, shownAs.empty() ? path : shownAs); });
    return {std::move(mesh), file.contentHash()};
}

} // namespace rt
