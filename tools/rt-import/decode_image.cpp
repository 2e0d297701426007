#include "tools/rt-import/decode_image.h"

#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <utility>

namespace rt {
namespace {

bool startsWith(std::span<const std::byte> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}
bool isExr(std::span<const std::byte> bytes) {
    return startsWith(bytes, "\x76\x2f\x31\x01");
}

[[noreturn]] void throwNoMemory(const std::string& name, std::span<const std::byte> bytes,
                                const std::string& size) {
    throw Error(ErrorKind::LimitExceeded,
                fmt::format("{}: memory does not suffice to decode this image{} ({} bytes as a file); raise "
                            "--max-memory or scale it down",
                            name, size, bytes.size()));
}

// stb_image's own reasons are not shown: they may be those of another kind of image that it tried.
std::string faultOf(std::span<const std::byte> bytes) {
    constexpr std::array<std::pair<std::string_view, const char*>, 6> kKinds{{{"\x89PNG", "PNG"},
                                                                              {"\xff\xd8", "JPEG"},
                                                                              {"GIF8", "GIF"},
                                                                              {"BM", "BMP"},
                                                                              {"8BPS", "PSD"},
                                                                              {"P", "PNM"}}};
    for (const auto& [magic, kind] : kKinds)
        if (startsWith(bytes, magic))
            return fmt::format("cannot be decoded: a {} of {} bytes, cut short, damaged or of a rare kind",
                               kind, bytes.size());
    return fmt::format("cannot be decoded: {} bytes of no known kind", bytes.size());
}

// The decoder does not always tell when memory was what it lacked.
bool isMemoryLeft(std::size_t pixelCount) {
    constexpr std::size_t kBytesPerPixel = 12; // unpacked, put in order, and made RGBA
    void* volatile const room = ::operator new(pixelCount* kBytesPerPixel, std::nothrow);
    ::operator delete(room);
    return room != nullptr;
}

// Of a PNG whose bytes cannot be unpacked to the pixels that it claims, for which no memory need be had.
bool claimsTooMuch(std::span<const std::byte> bytes, std::uint64_t width, std::uint64_t height) {
    constexpr std::size_t kDepthAt = 24, kColorTypeAt = 25;
    constexpr std::array<unsigned, 7> kSamples{1, 0, 3, 1, 2, 0, 4}; // of a pixel, by colour type
    constexpr std::uint64_t kMostPerByte =
        1032; // of what deflate packs. Source: RFC 1951, 258 bytes in 2 bits
    if (!startsWith(bytes, "\x89PNG") || bytes.size() <= kColorTypeAt) return false;
    const auto type = std::min(std::to_integer<std::size_t>(bytes[kColorTypeAt]), kSamples.size() - 1);
    const std::uint64_t bits = width * kSamples[type] * std::to_integer<unsigned>(bytes[kDepthAt]);
    return height * (1 + bits / 8) / kMostPerByte > bytes.size();
}

DecodedImage decodeBytes(std::span<const std::byte> bytes, const std::string& name,
                         std::vector<std::uint32_t>& pixels) {
    if (bytes.empty() || bytes.size() > INT_MAX)
        return {.fault = bytes.empty() ? "is empty" : "exceeds 2 GiB"};
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(data, size, &width, &height, &channels)) return {.fault = faultOf(bytes)};
    requireImageRoom(width, height, name, pixels); // before the pixels are allocated
    if (claimsTooMuch(bytes, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)))
        return {.fault = faultOf(bytes)};
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> rgba(
        stbi_load_from_memory(data, size, &width, &height, &channels, 4), &stbi_image_free);
    const std::size_t first = pixels.size();
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (!rgba && !isMemoryLeft(count))
        throwNoMemory(name, bytes, fmt::format(" of {}x{} pixels", width, height));
    if (!rgba) return {.fault = faultOf(bytes)};
    pixels.resize(first + count);
    std::memcpy(pixels.data() + first, rgba.get(), count * 4);
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), first, ""};
}

constexpr float kMostLight = 65504.0f; // of a texture; what an EXR's half floats reach

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
DecodedImage storeFloats(const Image& image, const std::string& name, PixelValues values,
                         std::vector<std::uint32_t>& pixels) {
    requireImageRoom(image.width, image.height, name, pixels);
    const std::array colors = {&colorChannel(image, "R", name).values, &colorChannel(image, "G", name).values,
                               &colorChannel(image, "B", name).values};
    const ImageChannel* alpha = image.find("A");
    if (alpha && alpha->type == ImageChannel::Type::Uint) alpha = nullptr;
    DecodedImage result{image.width, image.height, pixels.size(), ""};
    if (values == PixelValues::Light)
        for (std::size_t i = 0; i < image.pixelCount(); ++i) {
            const glm::vec3 color = straightColor(colors, alpha, i);
            result.scale = std::max({result.scale, color.r, color.g, color.b});
        }
    for (std::size_t i = 0; i < image.pixelCount(); ++i) {
        const glm::dvec3 color = glm::dvec3(straightColor(colors, alpha, i)) / double(result.scale);
        std::uint32_t pixel = byteOf(alpha ? double(alpha->values[i]) : 1.0) << 24;
        for (int c = 0; c < 3; ++c)
            pixel |= byteOf(values == PixelValues::Numbers ? color[c] : encodeSrgb(std::min(color[c], 1.0)))
                     << (8 * c);
        pixels.push_back(pixel);
    }
    return result;
}

DecodedImage decodeFloats(std::span<const std::byte> bytes, const std::string& name, PixelValues values,
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

} // namespace

bool holdsFloats(std::span<const std::byte> bytes) {
    return isExr(bytes) || startsWith(bytes, "#?RADIANCE") || startsWith(bytes, "#?RGBE");
}

void requireImageRoom(std::int64_t width, std::int64_t height, const std::string& name,
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

DecodedImage decodeImage(std::span<const std::byte> bytes, const std::string& name, PixelValues values,
                         std::vector<std::uint32_t>& pixels) {
    try {
        return holdsFloats(bytes) ? decodeFloats(bytes, name, values, pixels)
                                  : decodeBytes(bytes, name, pixels);
    } catch (const std::bad_alloc&) {
        throwNoMemory(name, bytes, "");
    }
}

} // namespace rt
