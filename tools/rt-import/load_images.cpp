#include "tools/rt-import/load_images.h"

#include "common/binary_io.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <map>
#include <tuple>
#include <unistd.h>

namespace rt {
namespace {

PixelValues valuesFor(TextureUse use) {
    if (use == TextureUse::Emission) return PixelValues::Light;
    return use == TextureUse::BaseColor ? PixelValues::Colors : PixelValues::Numbers;
}

// Bare pixels of an image inside the model.
DecodedImage decodeBare(const aiTexture& texture, const std::string& name,
                        std::vector<std::uint32_t>& pixels) {
    if (texture.mWidth == 0 || !texture.pcData) return {.fault = "is empty"};
    requireImageRoom(texture.mWidth, texture.mHeight, name, pixels);
    const std::size_t first = pixels.size();
    const std::size_t count = std::size_t(texture.mWidth) * texture.mHeight;
    for (std::size_t i = 0; i < count; ++i) {
        const aiTexel& t = texture.pcData[i];
        pixels.push_back(std::uint32_t(t.r) | std::uint32_t(t.g) << 8 | std::uint32_t(t.b) << 16 |
                         std::uint32_t(t.a) << 24);
    }
    return {texture.mWidth, texture.mHeight, first, ""};
}

constexpr const char* kNotFound = "was not found in the model's folder or below, nor in a --texture-root";
constexpr std::uint32_t kAlphaMask = 0xFF000000u;

bool isClearSomewhere(std::span<const std::uint32_t> pixels) {
    return std::any_of(pixels.begin(), pixels.end(), [](std::uint32_t p) { return p < kAlphaMask; });
}

// Normals point away from the surface, which is blue, and heights are grey.
bool lookLikeNormals(std::span<const std::uint32_t> pixels) {
    std::uint64_t r = 0, g = 0, b = 0;
    for (const std::uint32_t p : pixels) {
        r += p & 255u;
        g += p >> 8 & 255u;
        b += p >> 16 & 255u;
    }
    const std::uint64_t margin = 24 * pixels.size();
    return b > 160 * pixels.size() && b > r + margin && b > g + margin;
}

std::uint32_t spaceOf(TextureUse use) {
    return use == TextureUse::BaseColor || use == TextureUse::Emission ? kImageSrgb : kImageLinear;
}

constexpr char kInside = '\x01'; // no path begins like this

// A file, the one whose alpha it gets, and what becomes of its numbers.
using Version = std::tuple<std::string, std::string, PixelValues>;

class ImageLoader {
public:
    ImageLoader(const aiScene& scene, const ModelFolder& folder) : scene_(scene), folder_(folder) {}

    struct Loaded {
        std::uint32_t image = kNoImage;
        std::string fault; ///< why there is no image; beside one, why its alpha could not be had
        float scale = 1.0f;
    };

    Loaded load(const TextureSource& texture, TextureUse use) {
        const auto file = keyOf(texture, texture.name), alphaFile = keyOf(texture, texture.alphaName);
        if (!file || (file->empty() && !alphaFile)) return {.fault = kNotFound};
        const PixelValues values =
            file->empty() || !holdsFloats(bytesOf(*file)) ? PixelValues::Bytes : valuesFor(use);
        const Version version{*file, alphaFile.value_or(""), values};
        const auto [entry, isNew] = decoded_.try_emplace(version);
        if (isNew) entry->second = decodeWithAlpha(version);
        const DecodedImage& image = entry->second;
        if (image.width > 0 && texture.mayBeHeights && !lookLikeNormals(pixelsOf(image)))
            return {.fault = "holds heights, not normals"};
        const std::string fault =
            alphaFile ? image.fault : fmt::format("has no opacity: '{}' {}", texture.alphaName, kNotFound);
        return {image.width == 0 ? kNoImage : place(image, *file, texture, spaceOf(use)), fault, image.scale};
    }

    LoadedImages result;

private:
    // A mark and its number for an image inside the model, else a path; "" for "", nothing where no file is
    // found.
    std::optional<std::string> keyOf(const TextureSource& texture, const std::string& name) const {
        if (name.empty() || texture.isPath) return name;
        const int embedded = scene_.GetEmbeddedTextureAndIndex(name.c_str()).second;
        return embedded >= 0 ? kInside + std::to_string(embedded) : folder_.find(name);
    }

    const aiTexture* insideOf(const std::string& key) const {
        return key.starts_with(kInside) ? scene_.mTextures[std::stoul(key.substr(1))] : nullptr;
    }

    // Empty where there are none, or none to be had. A height of 0 marks an embedded file of mWidth bytes.
    SharedSpan<std::byte> bytesOf(const std::string& key) const {
        if (const aiTexture* inside = insideOf(key)) {
            const auto* bytes = reinterpret_cast<const std::byte*>(inside->pcData);
            return {{bytes, bytes && inside->mHeight == 0 ? inside->mWidth : 0u}, nullptr};
        }
        return faccessat(AT_FDCWD, key.c_str(), R_OK, AT_EACCESS) == 0 ? readFile(key)
                                                                       : SharedSpan<std::byte>();
    }

    std::span<std::uint32_t> pixelsOf(const DecodedImage& image) {
        return {result.pixels.data() + image.firstPixel, image.pixelCount()};
    }

    DecodedImage decodeAny(const std::string& key, PixelValues values, std::vector<std::uint32_t>& pixels) {
        const aiTexture* const inside = insideOf(key);
        const std::string name =
            inside ? fmt::format("{}: image {} inside it", folder_.modelPath(), key.substr(1)) : key;
        if (inside && inside->mHeight != 0) return decodeBare(*inside, name, pixels);
        const SharedSpan<std::byte> bytes = bytesOf(key);
        if (!inside && bytes.empty() && faccessat(AT_FDCWD, key.c_str(), R_OK, AT_EACCESS) != 0)
            return {.fault = fmt::format("cannot be opened: {}", std::strerror(errno))};
        return decodeImage(bytes, name, values, pixels);
    }

    // Decodes a file with its own alpha, that of another, or none (""). An image that is opaque anyway serves
    // as both of the first and the last.
    DecodedImage decodeWithAlpha(const Version& version) {
        const auto& [file, alphaFile, values] = version;
        if (file.empty()) return decodeAlphaOnly(alphaFile);
        const bool own = file == alphaFile;
        const auto other = decoded_.find({file, own ? "" : file, values});
        if ((own || alphaFile.empty()) && other != decoded_.end() && !other->second.isClear)
            return other->second;
        DecodedImage image = decodeAny(file, values, result.pixels);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        image.isClear = isClearSomewhere(pixels);
        if (own) return image;
        if (image.isClear)
            for (std::uint32_t& pixel : pixels) pixel |= kAlphaMask;
        if (!alphaFile.empty() && image.width > 0) takeAlpha(image, alphaFile);
        return image;
    }

    // White, of the size of the image whose alpha it takes.
    DecodedImage decodeAlphaOnly(const std::string& alphaFile) {
        DecodedImage image = decodeAny(alphaFile, PixelValues::Numbers, result.pixels);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        const bool ownAlpha = isClearSomewhere(pixels);
        for (std::uint32_t& p : pixels) p = (ownAlpha ? p & kAlphaMask : p << 24) | 0x00FFFFFFu;
        return image;
    }

    // The nearest texel's, where the sizes differ.
    void takeAlpha(DecodedImage& image, const std::string& alphaFile) {
        std::vector<std::uint32_t> alpha;
        const DecodedImage from = decodeAny(alphaFile, PixelValues::Numbers, alpha);
        if (from.width == 0) {
            image.fault = fmt::format("has no opacity: '{}' {}", alphaFile, from.fault);
            return;
        }
        const bool ownAlpha = isClearSomewhere(alpha);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const std::size_t x = i % image.width * from.width / image.width;
            const std::size_t y = i / image.width * from.height / image.height;
            const std::uint32_t p = alpha[y * from.width + x];
            pixels[i] = (pixels[i] & ~kAlphaMask) | (ownAlpha ? p & kAlphaMask : p << 24);
        }
    }

    std::uint32_t place(const DecodedImage& image, const std::string& file, const TextureSource& texture,
                        std::uint32_t space) {
        const auto next = static_cast<std::uint32_t>(result.images.size());
        // Versions that share their pixels share their image as well.
        const auto [entry, isNew] =
            placed_.try_emplace({file, image.firstPixel, texture.wrapU, texture.wrapV, space}, next);
        if (isNew)
            result.images.push_back(
                {image.width, image.height, texture.wrapU, texture.wrapV, image.firstPixel, space, 0});
        return entry->second;
    }

    const aiScene& scene_;
    const ModelFolder& folder_;
    std::map<Version, DecodedImage> decoded_;
    std::map<std::tuple<std::string, std::uint64_t, std::uint32_t, std::uint32_t, std::uint32_t>,
             std::uint32_t>
        placed_;
};

std::uint32_t& imageOf(Material& material, TextureUse use) {
    if (use == TextureUse::Transmission) return material.more.x;
    return material.images[static_cast<int>(use)]; // the first four stand in this order
}

void scaleEmission(float scale, Material& material) {
    const vec3 scaled = glm::min(vec3(material.emission) * scale, vec3(std::numeric_limits<float>::max()));
    material.emission = vec4(scaled, 0.0f);
}

std::string consequenceOf(TextureUse use) {
    return use == TextureUse::Normals ? "there is no normal image" : "its factor stands alone";
}

} // namespace

LoadedImages loadImages(const aiScene& scene, std::vector<MaterialSource>& materials,
                        const ModelFolder& folder, std::vector<std::string>& warnings) {
    ImageLoader loader(scene, folder);
    for (MaterialSource& source : materials)
        for (unsigned i = 0; i < kTextureUses; ++i) {
            if (!source.textures[i]) continue;
            const auto use = static_cast<TextureUse>(i);
            const TextureSource texture = *source.textures[i];
            const ImageLoader::Loaded loaded = loader.load(texture, use);
            imageOf(source.material, use) = loaded.image;
            if (loaded.image == kNoImage) source.textures[i].reset();
            if (use == TextureUse::Emission) scaleEmission(loaded.scale, source.material);
            if (!loaded.fault.empty())
                warnings.push_back(
                    fmt::format("material '{}': texture '{}' {}; {}", source.name,
                                texture.name.empty() ? texture.alphaName : texture.name, loaded.fault,
                                loaded.image == kNoImage ? consequenceOf(use) : "it is opaque"));
        }
    return std::move(loader.result);
}

} // namespace rt
