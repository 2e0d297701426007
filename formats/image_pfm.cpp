#include "formats/image_pfm.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

namespace rt {
namespace {

// Takes the next word off `text`, and one white space behind it.
std::string_view takeWord(std::string_view& text) {
    constexpr std::string_view kSpace = " \t\r\n";
    text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
    const std::size_t size = std::min(text.find_first_of(kSpace), text.size());
    const std::string_view word = text.substr(0, size);
    text.remove_prefix(std::min(size + 1, text.size()));
    return word;
}

template <class T>
T takeNumber(std::string_view& text, const std::string& name, const char* what) {
    const std::string_view word = takeWord(text);
    T value{};
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc() || end != word.data() + word.size() || !(value != T(0)))
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged: its {} is no number but 0", name, what));
    return value;
}

float floatAt(const char* bytes, bool isBigEndian) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return std::bit_cast<float>(isBigEndian ? __builtin_bswap32(word) : word);
}

} // namespace

Picture decodePfm(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view magic = takeWord(text);
    if (magic != "PF" && magic != "Pf") throw Error(ErrorKind::InvalidContent, name + ": is no PFM picture");
    const std::size_t channels = magic == "PF" ? 3 : 1;
    const auto width = takeNumber<std::uint32_t>(text, name, "width");
    const auto height = takeNumber<std::uint32_t>(text, name, "height");
    const bool isBigEndian = takeNumber<double>(text, name, "scale") > 0.0;
    const std::uint64_t pixels = std::uint64_t(width) * height;
    requirePixels(width, height, limits.maxPixelsOf(channels), name);
    constexpr std::uint32_t kMaxSide = 1u << 30;
    if (std::max(width, height) > kMaxSide)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels: a side exceeds {}", name, width, height, kMaxSide));
    if (text.size() != pixels * channels * sizeof(float))
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged: {} x {} pixels take {} bytes, {} are there", name, width,
                                height, pixels * channels * sizeof(float), text.size()));
    const auto valueAt = [&](std::size_t x, std::size_t y, std::size_t c) {
        const std::size_t row = height - 1 - y; // the bottom comes first
        return floatAt(text.data() + ((row * width + x) * channels + c) * sizeof(float), isBigEndian);
    };
    return singlePartPicture(name, "PFM", ValueScale::Linear,
                             imageOfPixels(width, height, channels == 1 ? "Y" : "RGB", valueAt));
}

} // namespace rt
