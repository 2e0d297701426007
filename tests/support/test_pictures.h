#pragma once
#include "formats/picture.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace rt::test {

inline ImageChannel floats(const char* name, std::vector<float> values) {
    return {name, ImageChannel::Type::Float, std::move(values), {}};
}
inline ImageChannel uints(const char* name, std::vector<std::uint32_t> values) {
    return {name, ImageChannel::Type::Uint, {}, std::move(values)};
}

inline Image imageOf(std::uint32_t width, std::uint32_t height, std::vector<ImageChannel> channels) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = std::move(channels);
    return image;
}

/// A part without a name whose data window is the whole picture.
inline PicturePart partOf(Image image) {
    PicturePart part;
    part.dataWindow = part.displayWindow = {0, 0, static_cast<std::int32_t>(image.width),
                                            static_cast<std::int32_t>(image.height)};
    part.image = std::move(image);
    return part;
}

inline Picture pictureOf(Image image) {
    return {"test", "EXR", ValueScale::Linear, {partOf(std::move(image))}};
}

} // namespace rt::test
