#pragma once
#include "tools/rt-import/read_textures.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rt {

inline constexpr std::uint32_t kMaxImageSide = 16384; // what every GL 4.5 device takes as a texture
inline constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 28; // of all images: 2^30 bytes

/// How the numbers of a picture in floating point become bytes; those of others are bytes already.
enum class PixelValues {
    Bytes,   ///< as they are
    Colors,  ///< clamped to 0..1, as sRGB
    Numbers, ///< clamped to 0..1
    Light    ///< as sRGB, divided by the largest of them if that is over 1
};

struct DecodedImage {
    std::uint32_t width = 0; ///< 0 = could not be decoded
    std::uint32_t height = 0;
    std::uint64_t firstPixel = 0;
    std::string fault;    ///< why it could not, or what it lacks
    bool isClear = false; ///< somewhere, by its alpha; set by the caller
    float scale = 1.0f;   ///< what its colours are to be multiplied by

    std::size_t pixelCount() const { return std::size_t(width) * height; }
};

/// Whether a file's pixels are numbers in floating point: OpenEXR, Radiance HDR.
bool holdsFloats(std::span<const std::byte> bytes);

/// Decodes a file of any kind that is known and appends its pixels, RGBA8, top row first. Without an image if
/// it is damaged. Throws Error{LimitExceeded}, message prefixed by `name`, for one that is wider or higher
/// than kMaxImageSide, that makes more than kMaxPixels, before it is decoded, or that memory does not suffice
/// for.
DecodedImage decodeImage(std::span<const std::byte> bytes, const std::string& name, PixelValues values,
                         std::vector<std::uint32_t>& pixels);

/// Throws Error{LimitExceeded} for an image of that size, as decodeImage() does.
void requireImageRoom(std::int64_t width, std::int64_t height, const std::string& name,
                      const std::vector<std::uint32_t>& pixels);

} // namespace rt
