#include "formats/image_hdr.h"

#include "common/error.h"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <limits>
#include <memory>

namespace rt {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 27;
constexpr std::uint64_t kPixelsPerByte = 16; // at most: runs of 127 in two bytes for each of four components

struct FreeStb {
    void operator()(float* values) const { stbi_image_free(values); }
};

ImageChannel channelOf(const char* name, const float* values, std::size_t count, std::size_t component) {
    ImageChannel channel;
    channel.name = name;
    channel.values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) channel.values.push_back(values[3 * i + component]);
    return channel;
}

} // namespace

Image decodeHdr(std::span<const std::byte> bytes, const std::string& name) {
    const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const auto size = static_cast<int>(bytes.size());
    if (bytes.size() > std::size_t(std::numeric_limits<int>::max()))
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: {} bytes exceed 2 GiB", name, bytes.size()));
    int width = 0, height = 0, channels = 0;
    if (!stbi_is_hdr_from_memory(data, size) ||
        !stbi_info_from_memory(data, size, &width, &height, &channels) || width <= 0 || height <= 0)
        throw Error(ErrorKind::InvalidContent, name + ": is no Radiance HDR picture");
    const std::uint64_t count = std::uint64_t(unsigned(width)) * unsigned(height);
    if (count > kMaxPixels)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels exceed {}", name, width, height, kMaxPixels));
    if (count / kPixelsPerByte > bytes.size())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged or truncated: {} bytes cannot hold {} x {} pixels", name,
                                bytes.size(), width, height));
    const std::unique_ptr<float, FreeStb> values(
        stbi_loadf_from_memory(data, size, &width, &height, &channels, 3));
    if (!values)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged: {}", name, stbi_failure_reason()));
    Image image;
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    image.channels = {channelOf("B", values.get(), count, 2), channelOf("G", values.get(), count, 1),
                      channelOf("R", values.get(), count, 0)};
    return image;
}

} // namespace rt
