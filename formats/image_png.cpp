#include "formats/image_png.h"

#include "common/error.h"
#include "formats/recipe.h"

#include <fmt/format.h>
#include <stb/stb_image_write.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

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

std::array<std::byte, 4> bigEndian(std::uint32_t value) {
    std::array<std::byte, 4> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(value >> (24 - 8 * i));
    return bytes;
}

// Before the last chunk, IEND, which has no data.
void insertText(const std::string& key, const std::string& text, std::vector<std::byte>& png) {
    constexpr std::ptrdiff_t kEndChunkBytes = 12;
    const std::string chunk = pngTextHead(key) + text;
    const auto chunkBytes = std::as_bytes(std::span(chunk));
    constexpr std::size_t kTypeBytes = 4;
    const auto size = bigEndian(static_cast<std::uint32_t>(chunk.size() - kTypeBytes));
    const auto crc = pngCrc(chunkBytes);
    std::vector<std::byte> whole(size.begin(), size.end());
    whole.insert(whole.end(), chunkBytes.begin(), chunkBytes.end());
    whole.insert(whole.end(), crc.begin(), crc.end());
    png.insert(png.end() - kEndChunkBytes, whole.begin(), whole.end());
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
    if (const auto text = image.texts.find(kRecipeKey); text != image.texts.end())
        insertText(text->first, text->second, bytes);
    return bytes;
}

bool isPng(std::span<const std::byte> bytes) {
    constexpr std::string_view kMagic = "\x89PNG\r\n\x1a\n";
    return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

std::string pngTextHead(const std::string& key) {
    return "tEXt" + key + '\0';
}

std::array<std::byte, kPngCrcBytes> pngCrc(std::span<const std::byte> chunk) {
    const auto* data = reinterpret_cast<const Bytef*>(chunk.data());
    return bigEndian(static_cast<std::uint32_t>(crc32_z(0, data, chunk.size())));
}

} // namespace rt
