#include "formats/image.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_png.h"

#include <fmt/format.h>

namespace rt {
namespace {

enum class FileType { Exr, Png, Unknown };

FileType typeOf(const std::string& path) {
    const std::size_t dot = path.find_last_of("./");
    std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (extension == ".exr") return FileType::Exr;
    if (extension == ".png") return FileType::Png;
    return FileType::Unknown;
}

} // namespace

const ImageChannel* Image::find(const std::string& name) const {
    for (const ImageChannel& channel : channels)
        if (channel.name == name) return &channel;
    return nullptr;
}

void writeImage(const std::string& path, const Image& image) {
    switch (typeOf(path)) {
    case FileType::Exr:
        return writeFile(path, encodeExr(image));
    case FileType::Png:
        return writeFile(path, encodePng(image));
    case FileType::Unknown:
        break;
    }
    throw Error(ErrorKind::Usage,
                fmt::format("{}: pictures are written as .exr or .png; change the extension", path));
}

bool isImagePath(const std::string& path) {
    return typeOf(path) != FileType::Unknown;
}

} // namespace rt
