#include "tools/rt-import/scene_parts.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

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
    whole.droppedFaces += part.droppedFaces;
}

std::span<const std::uint32_t> pixelsOf(const MeshImage& image, const LoadedImages& images) {
    return {images.pixels.data() + image.firstPixel, std::size_t(image.width) * image.height};
}

// Where the same pixels are already, or will be once they are added.
std::uint64_t placeOf(const MeshImage& image, const LoadedImages& part, LoadedImages& whole,
                      const std::string& name) {
    const auto pixels = pixelsOf(image, part);
    for (const MeshImage& other : whole.images)
        if (other.width == image.width && other.height == image.height &&
            std::ranges::equal(pixelsOf(other, whole), pixels))
            return other.firstPixel;
    if (whole.pixels.size() + pixels.size() > kMaxPixels)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: with this model the textures exceed {} pixels (2^30 bytes) in all; scale them "
                        "down",
                        name, kMaxPixels));
    whole.pixels.insert(whole.pixels.end(), pixels.begin(), pixels.end());
    return whole.pixels.size() - pixels.size();
}

// The new number of each of the part's images.
std::vector<std::uint32_t> appendImages(const LoadedImages& part, LoadedImages& whole,
                                        const std::string& name) {
    std::vector<std::uint32_t> numbers;
    std::map<std::uint64_t, std::uint64_t> places; // pixels that images of the part share are looked for once
    for (MeshImage image : part.images) {
        const auto [place, isNew] = places.try_emplace(image.firstPixel, 0);
        if (isNew) place->second = placeOf(image, part, whole, name);
        image.firstPixel = place->second;
        const auto same = [&](const MeshImage& other) {
            return other.firstPixel == image.firstPixel && other.wrapU == image.wrapU &&
                   other.wrapV == image.wrapV && other.space == image.space;
        };
        const auto known = std::find_if(whole.images.begin(), whole.images.end(), same);
        numbers.push_back(static_cast<std::uint32_t>(known - whole.images.begin()));
        if (known == whole.images.end()) whole.images.push_back(image);
    }
    return numbers;
}

void renumber(const std::vector<std::uint32_t>& numbers, std::uint32_t& image) {
    if (image != kNoImage) image = numbers[image];
}

} // namespace

void append(SceneParts&& part, SceneParts& whole, const std::string& name) {
    appendAll(part.lights, whole.lights);
    appendAll(part.cameras, whole.cameras);
    if (whole.materials.empty()) { // the first one with triangles, and mostly the only one: nothing is copied
        whole.soup = std::move(part.soup);
        whole.materials = std::move(part.materials);
        whole.images = std::move(part.images);
        return;
    }
    requireRoom(part, whole, name);
    appendSoup(part.soup, static_cast<std::uint32_t>(whole.materials.size()), whole.soup);
    const std::vector<std::uint32_t> numbers = appendImages(part.images, whole.images, name);
    for (Material& material : part.materials) {
        for (int i = 0; i < 4; ++i) renumber(numbers, material.images[i]);
        renumber(numbers, material.more.x);
    }
    appendAll(part.materials, whole.materials);
}

} // namespace rt
