#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// One named channel: width*height values, row by row from the top.
struct ImageChannel {
    enum class Type { Half, Float, Uint };
    std::string name;                 ///< as EXR names it: "R", "N.X", "id"
    Type type = Type::Float;          ///< how a file stores it; in memory half and float are both `values`
    std::vector<float> values;        ///< Half and Float channels
    std::vector<std::uint32_t> uints; ///< Uint channels
};

/// Where an image lies in a larger picture, of which it holds a part.
struct ImageFrame {
    std::int32_t x = 0; ///< of the image's first pixel, counted from the whole picture's
    std::int32_t y = 0;
    std::uint32_t width = 0; ///< of the whole picture
    std::uint32_t height = 0;
    bool operator==(const ImageFrame&) const = default;
};

struct Image {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::optional<ImageFrame> frame = {}; ///< absent: the image is the whole picture
    std::vector<ImageChannel> channels;   ///< sorted by name, names unique
    /// Attributes of the EXR header that are not structural: text, numbers and 4x4 matrices (16 floats,
    /// row-major as EXR stores them).
    std::map<std::string, std::string> texts;
    std::map<std::string, float> floats;
    std::map<std::string, std::int32_t> ints;
    std::map<std::string, std::vector<float>> matrices;

    const ImageChannel* find(const std::string& name) const;
    std::size_t pixelCount() const { return std::size_t(width) * height; }
};

/// An image of float channels, one for each letter of `names`: valueAt(x, y, position of the letter).
template <class ValueAt>
Image imageOfPixels(std::uint32_t width, std::uint32_t height, std::string_view names, ValueAt&& valueAt) {
    Image image;
    image.width = width;
    image.height = height;
    for (std::size_t c = 0; c < names.size(); ++c) {
        std::vector<float> values;
        values.reserve(image.pixelCount());
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) values.push_back(valueAt(x, y, c));
        image.channels.push_back(
            {std::string(1, names[c]), ImageChannel::Type::Float, std::move(values), {}});
    }
    std::ranges::sort(image.channels, {}, &ImageChannel::name);
    return image;
}

/// Throws Error{LimitExceeded} prefixed by `name` above `most` pixels.
void requirePixels(std::uint64_t width, std::uint64_t height, std::uint64_t most, const std::string& name);

/// From the last point of a file's name on, in lower case: ".exr"; empty if there is none.
std::string extensionOf(const std::string& path);

enum class ImageFileType { Exr, Png };

/// What the path's extension stands for, in upper or lower case; nothing for any other extension.
std::optional<ImageFileType> imageFileType(const std::string& path);

/// Linear light of an sRGB-encoded value, both 0 to 1. Source: IEC 61966-2-1.
double decodeSrgb(double encoded);
double encodeSrgb(double linear);

/// Of linear light with the primaries of Rec. 709. Source: ITU-R BT.709.
constexpr double luminanceOf(double r, double g, double b) {
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/// The channel "R", "G" or "B", or Y in its place. Throws Error{InvalidContent} prefixed by `name` if the
/// image has neither.
const ImageChannel& colorChannel(const Image& image, const char* channel, const std::string& name);

/// The bytes of a single-part scanline EXR with ZIP compression, or of a PNG, which does not know of frames,
/// of R, G, B (A) clamped to [0,1] and sRGB-encoded, by the path's extension. Same image, same bytes. Throws
/// Error{Usage} for another extension or a PNG without those channels, Error{LimitExceeded} for a PNG that is
/// too large.
std::vector<std::byte> encodeImage(const std::string& path, const Image& image);

/// Writes what encodeImage() gives. Throws as it does, and Error{FileAccess}.
void writeImage(const std::string& path, const Image& image);

} // namespace rt
