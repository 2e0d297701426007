#include "formats/image_hdr.h"

#include "common/error.h"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string_view>

namespace rt {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 27;
constexpr std::uint64_t kPixelsPerByte = 16; // at most: runs of 127 in two bytes for each of four components

struct FreeStb {
    void operator()(float* values) const { stbi_image_free(values); }
};

/// The bytes of a picture's rows, which follow the line that gives its size.
std::span<const std::uint8_t> rowsOf(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t header = text.find("\n\n");
    const std::size_t end = header == text.npos ? text.npos : text.find('\n', header + 2);
    if (end == text.npos) return {};
    return {reinterpret_cast<const std::uint8_t*>(bytes.data()) + end + 1, bytes.size() - end - 1};
}

/// Takes one component of a row off `rest`: runs (a count above 128, a value) and copies (a count, values).
bool takeComponent(std::span<const std::uint8_t>& rest, std::size_t width) {
    for (std::size_t x = 0; x < width;) {
        if (rest.empty()) return false;
        const std::size_t count = rest[0] > 128 ? rest[0] - 128u : rest[0];
        const std::size_t bytes = rest[0] > 128 ? 2 : 1 + count;
        if (count == 0 || bytes > rest.size() || x + count > width) return false;
        rest = rest.subspan(bytes);
        x += count;
    }
    return true;
}

/// Whether all rows are there: the decoder would wait for ever for the rest of one (Ward 1991 describes
/// them).
bool hasAllRows(std::span<const std::uint8_t> rest, std::size_t width, std::size_t height) {
    const auto isPacked = [&] { return rest.size() >= 4 && rest[0] == 2 && rest[1] == 2 && rest[2] < 128; };
    if (width < 8 || width >= 32768 || !isPacked()) return rest.size() >= width * height * 4;
    for (std::size_t y = 0; y < height; ++y) {
        if (!isPacked() || (std::size_t(rest[2]) << 8 | rest[3]) != width) return false;
        rest = rest.subspan(4);
        for (int component = 0; component < 4; ++component)
            if (!takeComponent(rest, width)) return false;
    }
    return true;
}

} // namespace

Image decodeHdr(std::span<const std::byte> bytes, const std::string& name, std::uint64_t maxPixels) {
    const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const auto size = static_cast<int>(bytes.size());
    if (bytes.size() > std::size_t(std::numeric_limits<int>::max()))
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: {} bytes exceed 2 GiB", name, bytes.size()));
    int width = 0, height = 0, channels = 0;
    if (!stbi_is_hdr_from_memory(data, size) ||
        !stbi_info_from_memory(data, size, &width, &height, &channels) || width <= 0 || height <= 0)
        throw Error(ErrorKind::InvalidContent, name + ": is no Radiance HDR picture");
    const std::uint64_t count = std::uint64_t(unsigned(width)) * unsigned(height);
    requirePixels(unsigned(width), unsigned(height), std::min(maxPixels, kMaxPixels), name);
    if (count / kPixelsPerByte > bytes.size())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged or truncated: {} bytes cannot hold {} x {} pixels", name,
                                bytes.size(), width, height));
    if (!hasAllRows(rowsOf(bytes), std::size_t(width), std::size_t(height)))
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged or truncated: its {} rows are not all there", name, height));
    const std::unique_ptr<float, FreeStb> values(
        stbi_loadf_from_memory(data, size, &width, &height, &channels, 3));
    if (!values)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged: {}", name, stbi_failure_reason()));
    const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
    return imageOfPixels(columns, rows, "RGB", [&](std::size_t x, std::size_t y, std::size_t c) {
        return values.get()[(y * columns + x) * 3 + c];
    });
}

} // namespace rt
