#include "tools/rt-import/load_images.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <limits>
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
    float scale = 1.0f;   ///< what its colours are to be multiplied by

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

constexpr float kMostLight = 65504.0f; // of a texture; what an EXR's half floats reach

// How the numbers of a picture in floating point become bytes; those of others are bytes already.
enum class Values { Bytes, Colors, Numbers, Light };

bool startsWith(std::span<const std::byte> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}
bool isExr(std::span<const std::byte> bytes) {
    return startsWith(bytes, "\x76\x2f\x31\x01");
}
bool isFloat(std::span<const std::byte> bytes) {
    return isExr(bytes) || startsWith(bytes, "#?RADIANCE") || startsWith(bytes, "#?RGBE");
}

Values valuesFor(TextureUse use) {
    if (use == TextureUse::Emission) return Values::Light;
    return use == TextureUse::BaseColor ? Values::Colors : Values::Numbers;
}

// The three colours of a pixel without their alpha, which an EXR has multiplied them by.
glm::vec3 straightColor(const std::array<const std::vector<float>*, 3>& colors, const ImageChannel* alpha,
                        std::size_t i) {
    glm::vec3 color((*colors[0])[i], (*colors[1])[i], (*colors[2])[i]);
    if (alpha && alpha->values[i] > 0.0f && alpha->values[i] < 1.0f) color /= alpha->values[i];
    for (int c = 0; c < 3; ++c) color[c] = color[c] > 0.0f ? std::min(color[c], kMostLight) : 0.0f; // or NaN
    return color;
}

std::uint32_t byteOf(double unit) {
    return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(unit, 0.0, 1.0)));
}

// Light brighter than 1 keeps its range: it is stored as part of the brightest there is.
Decoded storeFloats(const Image& image, const std::string& name, Values values,
                    std::vector<std::uint32_t>& pixels) {
    requireRoom(image.width, image.height, name, pixels);
    const std::array colors = {&colorChannel(image, "R", name).values, &colorChannel(image, "G", name).values,
                               &colorChannel(image, "B", name).values};
    const ImageChannel* alpha = image.find("A");
    if (alpha && alpha->type == ImageChannel::Type::Uint) alpha = nullptr;
    Decoded result{image.width, image.height, pixels.size(), ""};
    if (values == Values::Light)
        for (std::size_t i = 0; i < image.pixelCount(); ++i) {
            const glm::vec3 color = straightColor(colors, alpha, i);
            result.scale = std::max({result.scale, color.r, color.g, color.b});
        }
    for (std::size_t i = 0; i < image.pixelCount(); ++i) {
        const glm::dvec3 color = glm::dvec3(straightColor(colors, alpha, i)) / double(result.scale);
        std::uint32_t pixel = byteOf(alpha ? double(alpha->values[i]) : 1.0) << 24;
        for (int c = 0; c < 3; ++c)
            pixel |= byteOf(values == Values::Numbers ? color[c] : encodeSrgb(std::min(color[c], 1.0)))
                     << (8 * c);
        pixels.push_back(pixel);
    }
    return result;
}

Decoded decodeFloats(std::span<const std::byte> bytes, const std::string& name, Values values,
                     std::vector<std::uint32_t>& pixels) {
    Image image;
    try {
        image = isExr(bytes) ? decodeExr(bytes, name) : decodeHdr(bytes, name);
        return storeFloats(image, name, values, pixels);
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::InvalidContent) throw;
        return {.fault = fmt::format("cannot be decoded: {}", error.what())};
    }
}

// Bare pixels of an image inside the model.
Decoded decodeBare(const aiTexture& texture, const std::string& name, std::vector<std::uint32_t>& pixels) {
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
using Version = std::tuple<std::string, std::string, Values>;

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
        const Values values = file->empty() || !isFloat(bytesOf(*file)) ? Values::Bytes : valuesFor(use);
        const Version version{*file, alphaFile.value_or(""), values};
        const auto [entry, isNew] = decoded_.try_emplace(version);
        if (isNew) entry->second = decodeWithAlpha(version);
        const Decoded& image = entry->second;
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

    std::span<std::uint32_t> pixelsOf(const Decoded& image) {
        return {result.pixels.data() + image.firstPixel, image.pixelCount()};
    }

    Decoded decodeAny(const std::string& key, Values values, std::vector<std::uint32_t>& pixels) {
        const aiTexture* const inside = insideOf(key);
        const std::string name = inside ? fmt::format("image {} of the model", key.substr(1)) : key;
        if (inside && inside->mHeight != 0) return decodeBare(*inside, name, pixels);
        const SharedSpan<std::byte> bytes = bytesOf(key);
        if (!inside && bytes.empty() && faccessat(AT_FDCWD, key.c_str(), R_OK, AT_EACCESS) != 0)
            return {.fault = fmt::format("cannot be opened: {}", std::strerror(errno))};
        return isFloat(bytes) ? decodeFloats(bytes, name, values, pixels) : decode(bytes, name, pixels);
    }

    // Decodes a file with its own alpha, that of another, or none (""). An image that is opaque anyway serves
    // as both of the first and the last.
    Decoded decodeWithAlpha(const Version& version) {
        const auto& [file, alphaFile, values] = version;
        if (file.empty()) return decodeAlphaOnly(alphaFile);
        const bool own = file == alphaFile;
        const auto other = decoded_.find({file, own ? "" : file, values});
        if ((own || alphaFile.empty()) && other != decoded_.end() && !other->second.isClear)
            return other->second;
        Decoded image = decodeAny(file, values, result.pixels);
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
        Decoded image = decodeAny(alphaFile, Values::Numbers, result.pixels);
        const std::span<std::uint32_t> pixels = pixelsOf(image);
        const bool ownAlpha = isClearSomewhere(pixels);
        for (std::uint32_t& p : pixels) p = (ownAlpha ? p & kAlphaMask : p << 24) | 0x00FFFFFFu;
        return image;
    }

    // The nearest texel's, where the sizes differ.
    void takeAlpha(Decoded& image, const std::string& alphaFile) {
        std::vector<std::uint32_t> alpha;
        const Decoded from = decodeAny(alphaFile, Values::Numbers, alpha);
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
    const ModelFolder& folder_;
    std::map<Version, Decoded> decoded_;
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
    return use == TextureUse::BaseColor ? "its colour factor stands alone"
                                        : fmt::format("there is no {} image", nameOf(use));
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
            if (loaded.image == kNoImage) dropTexture(source, use);
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
