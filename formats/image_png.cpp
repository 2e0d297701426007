#include "formats/image_png.h"

#include "common/error.h"

#include <fmt/format.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rt {
namespace {

// stb counts bytes in int and grows buffers by doubling.
constexpr std::size_t kMaxPngBytes = std::size_t(1) << 29;

std::uint8_t quantize(double unit) {
    return static_cast<std::uint8_t>(std::lround(unit * 255.0));
}

double clampToUnit(float value) {
    return std::isfinite(value) ? std::clamp(double(value), 0.0, 1.0) : 0.0;
}

const ImageChannel* findValues(const Image& image, const char* name) {
    const ImageChannel* channel = image.find(name);
    return channel && channel->type != ImageChannel::Type::Uint ? channel : nullptr;
}

void append(void* context, void* data, int size) {
    auto& bytes = *static_cast<std::vector<std::byte>*>(context);
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
}

} // namespace

std::vector<std::byte> encodePng(const Image& image) {
    std::vector<const ImageChannel*> channels;
    for (const char* name : {"R", "G", "B"}) {
        channels.push_back(findValues(image, name));
        if (!channels.back())
            throw Error(ErrorKind::Usage,
                        fmt::format("a PNG needs the channels R, G and B; {} is missing: write .exr", name));
    }
    if (const ImageChannel* alpha = findValues(image, "A")) channels.push_back(alpha);
    if (image.pixelCount() > kMaxPngBytes / channels.size())
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("a PNG of {} x {} pixels exceeds {} bytes: write .exr", image.width,
                                image.height, kMaxPngBytes));
    std::vector<std::uint8_t> pixels(image.pixelCount() * channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c) {
        for (std::size_t i = 0; i < image.pixelCount(); ++i) {
            const double unit = clampToUnit(channels[c]->values[i]);
            pixels[i * channels.size() + c] = quantize(c < 3 ? encodeSrgb(unit) : unit);
        }
    }
    std::vector<std::byte> bytes;
    const int count = static_cast<int>(channels.size());
    const int width = static_cast<int>(image.width);
    if (!stbi_write_png_to_func(append, &bytes, width, static_cast<int>(image.height), count, pixels.data(),
                                width * count))
        throw std::bad_alloc(); // the only way in which the encoder fails
    return bytes;
}

} // namespace rt
