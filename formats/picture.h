#pragma once
#include "formats/image.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rt {

/// A rectangle of pixels: x from the left, y from the top, in a picture's own coordinates.
struct PixelBox {
    std::int32_t x0 = 0, y0 = 0;
    std::int32_t x1 = 0, y1 = 0; ///< beyond the last pixel

    std::uint32_t width() const { return extent(x0, x1); }
    std::uint32_t height() const { return extent(y0, y1); }
    std::uint64_t pixelCount() const { return std::uint64_t(width()) * height(); }
    bool operator==(const PixelBox&) const = default;

private:
    static std::uint32_t extent(std::int32_t from, std::int32_t to) { // which may be more than an int holds
        return to > from ? static_cast<std::uint32_t>(to) - static_cast<std::uint32_t>(from) : 0u;
    }
};

/// One picture of a file. Only EXR files may hold several.
struct PicturePart {
    std::string name;         ///< of an EXR's part; empty where the file gives none
    PixelBox dataWindow;      ///< where the pixels of `image` lie: dataWindow.width() is image.width
    PixelBox displayWindow;   ///< the whole picture
    float pixelAspect = 1.0f; ///< width of a pixel over its height
    /// What an EXR says of its camera beside matrices, as text: screenWindowWidth, screenWindowCenter, view,
    /// envmap (the last two if given). Other formats have what EXR has if nothing is said.
    std::map<std::string, std::string> camera{{"screenWindowCenter", "0 0"}, {"screenWindowWidth", "1"}};
    std::optional<std::array<float, 8>> chromaticities; ///< CIE x, y of red, green, blue and white
    Image image; ///< channels and other attributes; its `frame` is not set
};

/// What the numbers of a picture stand for.
enum class ValueScale {
    Linear,  ///< light: EXR, PFM, Radiance HDR
    Display, ///< 0 to 1, sRGB-encoded: PNG, JPEG
};

struct Picture {
    std::string name;   ///< of the file, for messages
    std::string format; ///< "EXR", "PNG, 16 bits", ...
    ValueScale scale = ValueScale::Linear;
    std::vector<PicturePart> parts; ///< at least one
};

/// A picture of one part, without a name, whose windows are those of the image.
Picture singlePartPicture(const std::string& name, std::string format, ValueScale scale, Image&& image);

/// What a reader accepts.
struct PictureLimits {
    std::uint64_t maxPixels = std::uint64_t(1) << 28; ///< of each part
    std::uint64_t maxValues = std::uint64_t(1) << 31; ///< of the file: pixels times channels, 4 bytes each
    bool allCompressions =
        false; ///< EXR: also PIZ, PXR24, B44, B44A, DWAA and DWAB, whose decoders had holes
    std::string allCompressionsOption = {}; ///< how the user sets it, for messages; empty: not at all

    /// Of a picture of one part.
    std::uint64_t maxPixelsOf(std::size_t channels) const {
        return std::min(maxPixels, maxValues / channels);
    }
};

/// Decodes an EXR (any parts that are flat), PNG (8 or 16 bits), JPEG, PFM or Radiance HDR picture, whichever
/// the bytes are. Grey pictures have one channel, Y. Safe for untrusted bytes. Throws Error{InvalidContent}
/// or Error{LimitExceeded} prefixed by `name`.
Picture decodePicture(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits);

/// decodePicture() of a file; "-" is standard input. Throws Error{FileAccess} too.
Picture readPicture(const std::string& path, const PictureLimits& limits);

} // namespace rt
