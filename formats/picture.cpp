#include "formats/picture.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"
#include "formats/image_jpeg.h"
#include "formats/image_pfm.h"
#include "formats/image_png.h"

#include <string_view>

namespace rt {
namespace {

enum class PictureType { Exr, Png, Jpeg, Pfm, Hdr };

constexpr std::size_t kMagicBytes = 8;

std::optional<PictureType> typeOf(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x76\x2f\x31\x01")) return PictureType::Exr;
    if (text.starts_with("\x89PNG\r\n\x1a\n")) return PictureType::Png;
    if (text.starts_with("\xff\xd8\xff")) return PictureType::Jpeg;
    if (text.starts_with("#?")) return PictureType::Hdr;
    if (text.starts_with("PF") || text.starts_with("Pf")) return PictureType::Pfm;
    return std::nullopt;
}

PictureType requireType(std::span<const std::byte> bytes, const std::string& name) {
    const std::optional<PictureType> type = typeOf(bytes);
    if (!type)
        throw Error(ErrorKind::InvalidContent,
                    name + ": is not an OpenEXR file, nor a PNG, JPEG, PFM or Radiance HDR picture");
    return *type;
}

} // namespace

Picture singlePartPicture(const std::string& name, std::string format, ValueScale scale, Image&& image) {
    PicturePart part;
    part.dataWindow = part.displayWindow = {0, 0, static_cast<std::int32_t>(image.width),
                                            static_cast<std::int32_t>(image.height)};
    part.image = std::move(image);
    Picture picture{name, std::move(format), scale, {}};
    picture.parts.push_back(std::move(part));
    return picture;
}

Picture decodePicture(std::span<const std::byte> bytes, const std::string& name,
                      const PictureLimits& limits) {
    switch (requireType(bytes, name)) {
    case PictureType::Exr:
        return {name, "EXR", ValueScale::Linear, decodeExrParts(bytes, name, limits)};
    case PictureType::Png:
        return decodePng(bytes, name, limits);
    case PictureType::Jpeg:
        return decodeJpeg(bytes, name, limits);
    case PictureType::Pfm:
        return decodePfm(bytes, name, limits);
    case PictureType::Hdr:
        break;
    }
    return singlePartPicture(name, "Radiance HDR", ValueScale::Linear,
                             decodeHdr(bytes, name, limits.maxPixelsOf(3)));
}

Picture readPicture(const std::string& path, const PictureLimits& limits) {
    const std::string name = inputName(path);
    const auto refuseOthers = [&](std::span<const std::byte> head) -> std::optional<std::uint64_t> {
        requireType(head, name);
        return std::nullopt;
    };
    return decodePicture(readFile(path, {kMagicBytes, refuseOthers, {}}), name, limits);
}

} // namespace rt
