#include "tools/rt-import/skip_unneeded.h"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <map>
#include <set>

namespace rt {
namespace {

constexpr std::uint32_t kUnseen = 0xFFFFFFFFu;

bool isInvisible(const Material& material) {
    return (material.more.y & kMaterialClear) != 0 && material.baseColor.w == 0.0f;
}

std::array<std::uint32_t*, kTextureUses> imagesOf(Material& material) {
    return {&material.images.x, &material.images.y, &material.images.z, &material.images.w, &material.more.x};
}

// Images that are kept, and where their pixels are; of those with equal pixels, where the first has them.
class ImageSet {
public:
    explicit ImageSet(std::span<const std::uint32_t> pixels) : pixels_(pixels) {}

    std::uint32_t add(MeshImage image) {
        image.firstPixel = firstEqual(image.firstPixel, std::size_t(image.width) * image.height);
        const auto same = [&](const MeshImage& other) {
            return other.firstPixel == image.firstPixel && other.width == image.width &&
                   other.height == image.height && other.wrapU == image.wrapU && other.wrapV == image.wrapV &&
                   other.space == image.space;
        };
        const auto found = std::find_if(images.begin(), images.end(), same);
        const auto index = static_cast<std::uint32_t>(found - images.begin());
        if (found == images.end()) images.push_back(image);
        return index;
    }

    /// Moves the pixels that are used to the front, and drops the rest.
    void closeGaps(std::vector<std::uint32_t>& pixels) {
        std::map<std::uint64_t, std::uint64_t> movedTo;
        std::uint64_t end = 0;
        for (const auto& [first, count] : blocks_) {
            const auto from = pixels.begin() + static_cast<std::ptrdiff_t>(first);
            std::copy(from, from + static_cast<std::ptrdiff_t>(count),
                      pixels.begin() + static_cast<std::ptrdiff_t>(end));
            movedTo[first] = end;
            end += count;
        }
        pixels.resize(end);
        for (MeshImage& image : images) image.firstPixel = movedTo.at(image.firstPixel);
    }

    std::vector<MeshImage> images;

private:
    std::uint64_t firstEqual(std::uint64_t first, std::size_t count) {
        const std::span<const std::uint32_t> block = pixels_.subspan(first, count);
        const std::uint64_t hash = XXH3_64bits(block.data(), block.size_bytes());
        const auto [begin, end] = firstOfHash_.equal_range(hash);
        for (auto known = begin; known != end; ++known)
            if (blocks_.at(known->second) == count &&
                std::equal(block.begin(), block.end(), pixels_.subspan(known->second).begin()))
                return known->second;
        firstOfHash_.emplace(hash, first);
        blocks_[first] = count;
        return first;
    }

    std::span<const std::uint32_t> pixels_;
    std::multimap<std::uint64_t, std::uint64_t> firstOfHash_;
    std::map<std::uint64_t, std::size_t> blocks_; // first pixel and count, in the order of the pixels
};

} // namespace

LeftOut countUnusedVertices(const SceneSoup& soup) {
    std::vector<bool> used(soup.positions.size(), false);
    for (const glm::uvec3& t : soup.triangles) used[t.x] = used[t.y] = used[t.z] = true;
    const auto count = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false));
    const std::size_t bytes = sizeof(glm::vec3) + (soup.normals.empty() ? 0 : sizeof(glm::vec3)) +
                              (soup.texcoords.empty() ? 0 : sizeof(glm::vec2));
    return {"unusedVertices", count, count * bytes};
}

LeftOut countUnusedTexcoords(const std::vector<MeshInstance>& instances, const SoupOptions& used) {
    LeftOut sets{"unusedTexcoords"};
    for (const MeshInstance& instance : instances) {
        const aiMesh& mesh = *instance.mesh;
        for (unsigned channel = 0; channel < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++channel) {
            const bool isUsed = used.texcoords && used.uvChannel[mesh.mMaterialIndex] == channel;
            if (isUsed || !mesh.HasTextureCoords(channel)) continue;
            ++sets.count;
            sets.bytes += mesh.mNumVertices * sizeof(glm::vec2);
        }
    }
    return sets;
}

LeftOut countUnusedTextures(const aiScene& scene, std::span<const MaterialSource> materials) {
    std::set<const aiTexture*> used;
    for (const MaterialSource& source : materials)
        for (const auto& texture : source.textures) {
            if (!texture) continue;
            used.insert(scene.GetEmbeddedTexture(texture->name.c_str()));
            used.insert(scene.GetEmbeddedTexture(texture->alphaName.c_str()));
        }
    LeftOut unused{"unusedTextures"};
    for (const aiTexture* texture : std::span(scene.mTextures, scene.mNumTextures)) {
        if (used.contains(texture)) continue;
        ++unused.count;
        unused.bytes +=
            texture->mHeight == 0 ? texture->mWidth : std::uint64_t(texture->mWidth) * texture->mHeight * 4;
    }
    return unused;
}

LeftOut dropInvisible(std::span<const Material> materials, SceneSoup& soup) {
    LeftOut triangles{"invisibleTriangles"};
    std::vector<bool> invisible(soup.triangles.size());
    for (std::size_t i = 0; i < invisible.size(); ++i) {
        invisible[i] = isInvisible(materials[soup.triangleMaterial[i]]);
        triangles.count += invisible[i];
    }
    if (triangles.count == invisible.size()) return {"invisibleTriangles"};
    if (triangles.count > 0) removeTriangles(soup, invisible);
    triangles.bytes = triangles.count * (sizeof(glm::uvec3) + sizeof(std::uint32_t));
    return triangles;
}

std::uint64_t dropUnusedMaterials(std::vector<std::uint32_t>& triangleMaterial,
                                  std::vector<Material>& materials) {
    std::vector<bool> unused(materials.size(), true);
    for (const std::uint32_t material : triangleMaterial) unused[material] = false;
    std::vector<std::uint32_t> numberOf(materials.size(), kUnseen);
    std::uint32_t kept = 0;
    for (std::size_t m = 0; m < materials.size(); ++m)
        if (!unused[m]) numberOf[m] = kept++;
    for (std::uint32_t& material : triangleMaterial) material = numberOf[material];
    removeMarked(materials, unused);
    return unused.size() - kept;
}

LeftOut dropUnusedImages(std::vector<Material>& materials, LoadedImages& loaded) {
    const std::size_t imageCount = loaded.images.size(), pixelCount = loaded.pixels.size();
    std::vector<std::uint32_t> numberOf(imageCount, kUnseen);
    ImageSet kept(loaded.pixels);
    for (Material& material : materials)
        for (std::uint32_t* image : imagesOf(material)) {
            if (*image == kNoImage) continue;
            std::uint32_t& number = numberOf[*image];
            if (number == kUnseen) number = kept.add(loaded.images[*image]);
            *image = number;
        }
    kept.closeGaps(loaded.pixels);
    loaded.images = std::move(kept.images);
    return {"unusedImages", imageCount - loaded.images.size(),
            (pixelCount - loaded.pixels.size()) * sizeof(std::uint32_t)};
}

void warnOfLost(const aiScene& scene, std::vector<std::string>& warnings) {
    unsigned colored = 0, skinned = 0, morphed = 0;
    for (const aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes)) {
        const std::span<const aiColor4D> colors(mesh->mColors[0],
                                                mesh->HasVertexColors(0) ? mesh->mNumVertices : 0u);
        colored += std::any_of(colors.begin(), colors.end(), [](const aiColor4D& c) {
            return c.r != 1.0f || c.g != 1.0f || c.b != 1.0f || c.a != 1.0f;
        });
        skinned += mesh->mNumBones > 0;
        morphed += mesh->mNumAnimMeshes > 0;
    }
    if (colored > 0)
        warnings.push_back(
            fmt::format("{} meshes have colours at their vertices, which are not carried over", colored));
    if (skinned > 0) warnings.push_back(fmt::format("{} meshes have bones; they stand as modelled", skinned));
    if (morphed > 0)
        warnings.push_back(
            fmt::format("{} meshes have other shapes to change into; they keep the first", morphed));
    if (scene.mNumAnimations > 0)
        warnings.push_back(fmt::format("{} animations are not carried over", scene.mNumAnimations));
}

} // namespace rt
