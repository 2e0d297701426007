#include "tools/rt-import/scene_parts.h"

#include "common/error.h"

#include <fmt/format.h>

namespace rt {
namespace {

template <class T>
void appendAll(const std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), from.begin(), from.end());
}

// As above, where one of the two may be empty though it has vertices: they have 0 then.
template <class T>
void appendOptional(const std::vector<T>& from, std::size_t fromCount, std::vector<T>& to,
                    std::size_t toCount) {
    if (from.empty() && to.empty()) return;
    to.resize(toCount, T(0.0f));
    appendAll(from, to);
    to.resize(toCount + fromCount, T(0.0f));
}

void requireRoom(const SceneParts& part, const SceneParts& whole, const std::string& name) {
    const std::uint64_t triangles = part.soup.triangles.size() + whole.soup.triangles.size();
    const std::uint64_t vertices = part.soup.positions.size() + whole.soup.positions.size();
    if (triangles > kMaxSoupCount || vertices > kMaxSoupCount)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: with this model the scene has {} triangles and {} vertices, more than {}; "
                        "split it",
                        name, triangles, vertices, kMaxSoupCount));
}

void appendSoup(const SceneSoup& part, std::uint32_t firstMaterial, SceneSoup& whole) {
    const std::size_t before = whole.positions.size(), more = part.positions.size();
    appendOptional(part.normals, more, whole.normals, before);
    appendOptional(part.texcoords, more, whole.texcoords, before);
    appendAll(part.positions, whole.positions);
    for (const glm::uvec3& triangle : part.triangles)
        whole.triangles.push_back(triangle + static_cast<std::uint32_t>(before));
    for (const std::uint32_t material : part.triangleMaterial)
        whole.triangleMaterial.push_back(material + firstMaterial);
    appendAll(part.origins, whole.origins);
}

void requireRoom(const LoadedImages& part, const LoadedImages& whole, const std::string& name) {
    if (whole.pixels.size() + part.pixels.size() > kMaxPixels)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: with this model the textures exceed {} pixels (2^30 bytes) in all; scale them "
                        "down",
                        name, kMaxPixels));
}

void appendImages(const LoadedImages& part, LoadedImages& whole) {
    for (MeshImage image : part.images) {
        image.firstPixel += whole.pixels.size();
        whole.images.push_back(image);
    }
    appendAll(part.pixels, whole.pixels);
}

} // namespace

void append(SceneParts&& part, SceneParts& whole, const std::string& name) {
    appendAll(part.lights, whole.lights);
    appendAll(part.cameras, whole.cameras);
    whole.unusedMaterials += part.unusedMaterials;
    if (whole.materials.empty()) { // the first one with triangles, and mostly the only one: nothing is copied
        whole.soup = std::move(part.soup);
        whole.materials = std::move(part.materials);
        whole.images = std::move(part.images);
        return;
    }
    requireRoom(part, whole, name);
    appendSoup(part.soup, static_cast<std::uint32_t>(whole.materials.size()), whole.soup);
    requireRoom(part.images, whole.images, name);
    const auto firstImage = static_cast<std::uint32_t>(whole.images.images.size());
    for (Material& material : part.materials) {
        for (int i = 0; i < 4; ++i)
            if (material.images[i] != kNoImage) material.images[i] += firstImage;
        if (material.more.x != kNoImage) material.more.x += firstImage;
    }
    appendImages(part.images, whole.images);
    appendAll(part.materials, whole.materials);
}

} // namespace rt
