#include "formats/image.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_png.h"

#include <cmath>
#include <fmt/format.h>

namespace rt {

std::string extensionOf(const std::string& path) {
    const std::size_t dot = path.find_last_of("./");
    if (dot == std::string::npos || path[dot] == '/') return "";
    std::string extension = path.substr(dot);
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

void requirePixels(std::uint64_t width, std::uint64_t height, std::uint64_t most, const std::string& name) {
    if (width * height > most)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels exceed {}", name, width, height, most));
}

std::optional<ImageFileType> imageFileType(const std::string& path) {
    const std::string extension = extensionOf(path);
    if (extension == ".exr") return ImageFileType::Exr;
    if (extension == ".png") return ImageFileType::Png;
    return std::nullopt;
}

const ImageChannel* Image::find(const std::string& name) const {
    for (const ImageChannel& channel : channels)
        if (channel.name == name) return &channel;
    return nullptr;
}

std::vector<std::byte> encodeImage(const std::string& path, const Image& image) {
    const std::optional<ImageFileType> type = imageFileType(path);
    if (!type)
        throw Error(ErrorKind::Usage,
                    fmt::format("{}: pictures are written as .exr or .png; change the extension", path));
    return *type == ImageFileType::Exr ? encodeExr(image) : encodePng(image);
}

double decodeSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double encodeSrgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

const ImageChannel& colorChannel(const Image& image, const char* channel, const std::string& name) {
    const ImageChannel* found = image.find(channel);
    if (!found) found = image.find("Y");
    if (!found || found->type == ImageChannel::Type::Uint)
        throw Error(
            ErrorKind::InvalidContent,
            fmt::format("{}: lacks the channel {}; a picture of light has R, G, B or Y", name, channel));
    return *found;
}

void writeImage(const std::string& path, const Image& image) {
    writeFile(path, encodeImage(path, image));
}

} // namespace rt
