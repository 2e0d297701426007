#include "tools/rt-import/load_images.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "tools/rt-import/model_folder.h"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <stb/stb_image.h>

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

class ImageLoader {
public:
    ImageLoader(const aiScene& scene, ModelFolder& folder) : scene_(scene), folder_(folder) {}

    // Index of the texture's image, or kNoImage and the reason.
    std::uint32_t load(const TextureSource& texture, std::string& fault) {
        const aiTexture* embedded = scene_.GetEmbeddedTexture(texture.name.c_str());
        const auto path = embedded ? std::optional(texture.name) : folder_.find(texture.name);
        if (!path) {
            fault = "was not found in the model's folder";
            return kNoImage;
        }
        if (!decoded_.contains(*path))
            decoded_[*path] = embedded ? decodeEmbedded(*embedded, *path, result.pixels) : decodeFile(*path);
        const Decoded& image = decoded_[*path];
        fault = image.fault;
        return image.width == 0 ? kNoImage : place(image, *path, texture);
    }

    LoadedImages result;

private:
    Decoded decodeFile(const std::string& path) {
        if (faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0)
            return {.fault = fmt::format("cannot be opened: {}", std::strerror(errno))};
        folder_.addRead(path);
        return decode(readFile(path), path, result.pixels);
    }

    std::uint32_t place(const Decoded& image, const std::string& path, const TextureSource& texture) {
        const auto next = static_cast<std::uint32_t>(result.images.size());
        const auto [entry, isNew] = placed_.try_emplace({path, texture.wrapU, texture.wrapV}, next);
        if (isNew)
            result.images.push_back(
                {image.width, image.height, texture.wrapU, texture.wrapV, image.firstPixel, kImageSrgb, 0});
        return entry->second;
    }

    const aiScene& scene_;
    ModelFolder& folder_;
    std::map<std::string, Decoded> decoded_;
    std::map<std::tuple<std::string, std::uint32_t, std::uint32_t>, std::uint32_t> placed_;
};

} // namespace

LoadedImages loadImages(const aiScene& scene, std::vector<MaterialSource>& materials, ModelFolder& folder,
                        std::vector<std::string>& warnings) {
    ImageLoader loader(scene, folder);
    for (MaterialSource& source : materials) {
        if (!source.texture) continue;
        std::string fault;
        source.material.images.x = loader.load(*source.texture, fault);
        if (!fault.empty())
            warnings.push_back(fmt::format("material '{}': texture '{}' {}; its colour factor stands alone",
                                           source.name, source.texture->name, fault));
    }
    return std::move(loader.result);
}

} // namespace rt
