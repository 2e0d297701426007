#include "tools/rt-import/load_images.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <memory>
#include <tuple>
#include <unistd.h>

namespace rt {
namespace {

struct Decoded {
    std::uint32_t width = 0; ///< 0 = could not be decoded
    std::uint32_t height = 0;
    std::uint64_t firstPixel = 0;
    std::string fault;
    bool isClear = false; ///< somewhere, by its alpha

    std::size_t pixelCount() const { return std::size_t(width) * height; }
};

// Checks an image of this size before its pixels are added.
void requireRoom(std::int64_t width, std::int64_t height, const std::string& name,
                 const std::vector<std::uint32_t>& pixels) {
    if (width > kMaxImageSide || height > kMaxImageSide)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: image of {}x{} pixels exceeds {} on a side; scale it down", name, width,
                                height, kMaxImageSide));
    if (pixels.size() + static_cast<std::uint64_t>(width * height) > kMaxPixels)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: with this image of {}x{} the textures exceed {} pixels (2^30 bytes) in "
                                "all; scale them down",
                                name, width, height, kMaxPixels));
}

Decoded decode(std::span<const std::byte> bytes, const std::string& name,
               std::vector<std::uint32_t>& pixels) {
    if (bytes.empty() || bytes.size() > INT_MAX)
        return {.fault = bytes.empty() ? "is empty" : "exceeds 2 GiB"};
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    const auto fault = [] { return fmt::format("cannot be decoded: {}", stbi_failure_reason()); };
    if (!stbi_info_from_memory(data, size, &width, &height, &channels)) return {.fault = fault()};
    requireRoom(width, height, name, pixels); // before the pixels are allocated
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> rgba(
        stbi_load_from_memory(data, size, &width, &height, &channels, 4), &stbi_image_free);
    if (!rgba) return {.fault = fault()};
    const std::size_t first = pixels.size();
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    pixels.resize(first + count);
    std::memcpy(pixels.data() + first, rgba.get(), count * 4);
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), first, ""};
}

// Height 0 marks an embedded file of mWidth bytes; anything else is bare pixels.
Decoded decodeEmbedded(const aiTexture& texture, const std::string& name,
                       std::vector<std::uint32_t>& pixels) {
    if (texture.mHeight == 0) {
        const auto* bytes = reinterpret_cast<const std::byte*>(texture.pcData);
        return decode({bytes, bytes ? texture.mWidth : 0u}, name, pixels);
    }
    if (texture.mWidth == 0 || !texture.pcData) return {.fault = "is empty"};
    requireRoom(texture.mWidth, texture.mHeight, name, pixels);
    const std::size_t first = pixels.size();
    const std::size_t count = std::size_t(texture.mWidth) * texture.mHeight;
    for (std::size_t i = 0; i < count; ++i) {
        const aiTexel& t = texture.pcData[i];
        pixels.push_back(std::uint32_t(t.r) | std::uint32_t(t.g) << 8 | std::uint32_t(t.b) << 16 |
                         std::uint32_t(t.a) << 24);
    }
    return {texture.mWidth, texture.mHeight, first, ""};
}

constexpr const char* kNotFound = "was not found in the model's folder";
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

class ImageLoader {
public:
    ImageLoader(const aiScene& scene, ModelFolder& folder) : scene_(scene), folder_(folder) {}

    // Index of the texture's image, or kNoImage and the reason. `fault` may be set beside an image, whose
    // alpha then could not be had.
    std::uint32_t load(const TextureSource& texture, std::uint32_t space, std::string& fault) {
        const auto file = pathOf(texture.name), alphaFile = pathOf(texture.alphaName);
        if (!file || (file->empty() && !alphaFile)) {
            fault = kNotFound;
            return kNoImage;
        }
        const FileAndAlpha files(*file, alphaFile.value_or(""));
        const auto [entry, isNew] = decoded_.try_emplace(files);
        if (isNew) entry->second = decodeWithAlpha(files.first, files.second);
        const Decoded& image = entry->second;
        fault =
            alphaFile ? image.fault : fmt::format("has no opacity: '{}' {}", texture.alphaName, kNotFound);
        if (image.width > 0 && texture.mayBeHeights && !lookLikeNormals(pixelsOf(image))) {
            fault = "holds heights, not normals";
            return kNoImage;
        }
        return image.width == 0 ? kNoImage : place(image, files.first, texture, space);
    }

    LoadedImages result;

private:
    using FileAndAlpha = std::pair<std::string, std::string>;

    // The name itself where it is inside the model, "" for "", nothing where no file is found.
    std::optional<std::string> pathOf(const std::string& name) const {
        return name.empty() || scene_.GetEmbeddedTexture(name.c_str()) ? name : folder_.find(name);
    }

    std::span<std::uint32_t> pixelsOf(const Decoded& image) {
        return {result.pixels.data() + image.firstPixel, image.pixelCount()};
    }

    Decoded decodeAny(const std::string& path, std::vector<std::uint32_t>& pixels) {
        if (const aiTexture* embedded = scene_.GetEmbeddedTexture(path.c_str()))
            return decodeEmbedded(*embedded, path, pixels);
        if (faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0)
            return {.fault = fmt::format("cannot be opened: {}", std::strerror(errno))};
        folder_.addRead(path);
        return decode(readFile(path), path, pixels);
    }

    // Decodes `file` with its own alpha, that of `alphaFile`, or none (""). An image that is opaque anyway
    // serves as both of the first and the last.
    Decoded decodeWithAlpha(const std::string& file, const std::string& alphaFile) {
        if (file.empty()) return decodeAlphaOnly(alphaFile);
        const bool own = file == alphaFile;
        const auto other = decoded_.find({file, own ? "" : file});
        if ((own || alphaFile.empty()) && other != decoded_.end() && !other->second.isClear)
            return other->second;
        Decoded image = decodeAny(file, result.pixels);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        image.isClear = isClearSomewhere(pixels);
        if (own) return image;
        if (image.isClear)
            for (std::uint32_t& pixel : pixels) pixel |= kAlphaMask;
        if (!alphaFile.empty() && image.width > 0) takeAlpha(image, alphaFile);
        return image;
    }

    // White, of the size of the image whose alpha it takes.
    Decoded decodeAlphaOnly(const std::string& alphaFile) {
        Decoded image = decodeAny(alphaFile, result.pixels);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        const bool ownAlpha = isClearSomewhere(pixels);
        for (std::uint32_t& p : pixels) p = (ownAlpha ? p & kAlphaMask : p << 24) | 0x00FFFFFFu;
        return image;
    }

    // The nearest texel's, where the sizes differ.
    void takeAlpha(Decoded& image, const std::string& alphaFile) {
        std::vector<std::uint32_t> alpha;
        const Decoded from = decodeAny(alphaFile, alpha);
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

    std::uint32_t place(const Decoded& image, const std::string& file, const TextureSource& texture,
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
    ModelFolder& folder_;
    std::map<FileAndAlpha, Decoded> decoded_;
    std::map<std::tuple<std::string, std::uint64_t, std::uint32_t, std::uint32_t, std::uint32_t>,
             std::uint32_t>
        placed_;
};

std::uint32_t spaceOf(TextureUse use) {
    return use == TextureUse::BaseColor || use == TextureUse::Emission ? kImageSrgb : kImageLinear;
}

std::uint32_t& imageOf(Material& material, TextureUse use) {
    if (use == TextureUse::Transmission) return material.more.x;
    return material.images[static_cast<int>(use)]; // the first four stand in this order
}

std::string consequenceOf(TextureUse use) {
    return use == TextureUse::BaseColor ? "its colour factor stands alone"
                                        : fmt::format("there is no {} image", nameOf(use));
}

} // namespace

LoadedImages loadImages(const aiScene& scene, std::vector<MaterialSource>& materials, ModelFolder& folder,
                        std::vector<std::string>& warnings) {
    ImageLoader loader(scene, folder);
    for (MaterialSource& source : materials)
        for (unsigned i = 0; i < kTextureUses; ++i) {
            if (!source.textures[i]) continue;
            const auto use = static_cast<TextureUse>(i);
            const TextureSource texture = *source.textures[i];
            std::string fault;
            std::uint32_t& image = imageOf(source.material, use);
            image = loader.load(texture, spaceOf(use), fault);
            if (image == kNoImage) dropTexture(source, use);
            if (!fault.empty())
                warnings.push_back(fmt::format("material '{}': texture '{}' {}; {}", source.name,
                                               texture.name.empty() ? texture.alphaName : texture.name, fault,
                                               image == kNoImage ? consequenceOf(use) : "it is opaque"));
        }
    return std::move(loader.result);
}

} // namespace rt
