#include "formats/exr_layout.h"

#include "common/error.h"

#include <fmt/format.h>

#include <array>

namespace rt {
namespace {

constexpr std::uint64_t kMaxTileBytes = std::uint64_t(1) << 28;

[[noreturn]] void throwInvalid(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::InvalidContent, name + ": " + what);
}

struct CompressionTraits {
    const char* name;
    std::uint64_t maxRatio; // bytes of memory that one byte of file can stand for
    std::uint64_t rowsPerChunk;
    bool isSafe; // no decoder of Debian's library has known holes
};

constexpr std::uint64_t kUnknownRatio = 1 << 16; // several stages, each of which shortens runs

// By the numbers that files have for them.
constexpr std::array kCompressions{CompressionTraits{"NONE", 1, 1, true},
                                   CompressionTraits{"RLE", 64, 1, true},    // a run of 128 in two bytes
                                   CompressionTraits{"ZIPS", 1032, 1, true}, // deflate: 258 in two bits
                                   CompressionTraits{"ZIP", 1032, 16, true},
                                   CompressionTraits{"PIZ", kUnknownRatio, 32, false},
                                   CompressionTraits{"PXR24", kUnknownRatio, 16, false},
                                   CompressionTraits{"B44", kUnknownRatio, 32, false},
                                   CompressionTraits{"B44A", kUnknownRatio, 32, false},
                                   CompressionTraits{"DWAA", kUnknownRatio, 32, false},
                                   CompressionTraits{"DWAB", kUnknownRatio, 256, false}};

const CompressionTraits& requireCompression(std::size_t number, const PictureLimits& limits,
                                            const std::string& name) {
    const CompressionTraits* const traits = number < kCompressions.size() ? &kCompressions[number] : nullptr;
    if (traits && (traits->isSafe || limits.allCompressions)) return *traits;
    const std::string remedy = traits && !limits.allCompressionsOption.empty()
                                   ? ", or trust it with " + limits.allCompressionsOption
                                   : "";
    throwInvalid(name, fmt::format("compression {} is not read; save it with NONE, RLE, ZIPS or ZIP{}",
                                   traits ? traits->name : fmt::format("number {}", number), remedy));
}

ExrLayout checkWindow(const ExrPartHeader& header, const PictureLimits& limits, const std::string& name) {
    constexpr int kMaxCoordinate = 1 << 30;
    for (const int value : {header.minX, header.minY, header.maxX, header.maxY})
        if (value < -kMaxCoordinate || value > kMaxCoordinate)
            throwInvalid(name, fmt::format("data window coordinate {} exceeds {}", value, kMaxCoordinate));
    if (header.maxX < header.minX || header.maxY < header.minY) throwInvalid(name, "data window is empty");
    const auto width = static_cast<std::uint64_t>(header.maxX - header.minX) + 1;
    const auto height = static_cast<std::uint64_t>(header.maxY - header.minY) + 1;
    requirePixels(width, height, limits.maxPixels, name);
    return {width, height, 0};
}

// Channels of less than the full size must fill whole blocks of pixels, as the library wants it.
void checkSampling(const ExrPartHeader::Channel& channel, const ExrPartHeader& header,
                   const ExrLayout& layout, bool isPlain, const std::string& name) {
    if (channel.isFull()) return;
    const int x = channel.xSampling, y = channel.ySampling;
    const std::string found = fmt::format("channel {} is subsampled {} x {}", channel.name, x, y);
    if (isPlain) throwInvalid(name, found + "; convert the picture to R G B");
    if (header.isTiled || x < 1 || y < 1 || header.minX % x != 0 || header.minY % y != 0 ||
        layout.width % std::uint64_t(x) != 0 || layout.height % std::uint64_t(y) != 0)
        throwInvalid(name, "header is damaged: " + found + ", which does not fit its data window");
}

struct ChannelTotals {
    std::uint64_t bytesPerPixel = 0; // of all channels at their full size
    std::uint64_t bytes = 0;
};

ChannelTotals checkChannels(const ExrPartHeader& header, const ExrLayout& layout, bool isPlain,
                            const std::string& name) {
    ChannelTotals totals;
    for (const ExrPartHeader::Channel& channel : header.channels) {
        if (!channel.type) throwInvalid(name, fmt::format("channel {} has an unknown type", channel.name));
        checkSampling(channel, header, layout, isPlain, name);
        const std::uint64_t bytes = *channel.type == ImageChannel::Type::Half ? 2 : 4;
        totals.bytesPerPixel += bytes;
        totals.bytes += bytes * (layout.width / std::uint64_t(channel.xSampling)) *
                        (layout.height / std::uint64_t(channel.ySampling));
    }
    if (header.channels.empty()) throwInvalid(name, "has no channels");
    return totals;
}

std::uint64_t countTiles(const ExrPartHeader& header, const ExrLayout& layout, std::uint64_t bytesPerPixel,
                         const std::string& name) {
    if (!header.tiles) throwInvalid(name, "header is damaged: tiled, but without a tile description");
    const ExrPartHeader::Tiles& tiles = *header.tiles;
    if (tiles.width == 0 || tiles.height == 0 || !tiles.hasKnownModes)
        throwInvalid(name, "header is damaged: invalid tile description");
    if (std::uint64_t(tiles.width) * tiles.height > kMaxTileBytes / bytesPerPixel)
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: tiles of {} x {} pixels exceed {} bytes", name,
                                                          tiles.width, tiles.height, kMaxTileBytes));
    return (layout.width + tiles.width - 1) / tiles.width *
           ((layout.height + tiles.height - 1) / tiles.height);
}

} // namespace

ExrLayout checkExrLayout(const ExrPartHeader& header, const ExrRules& rules, std::uint64_t fileBytes,
                         const std::string& name) {
    if (!header.type.empty() && header.type != "scanlineimage" && header.type != "tiledimage")
        throwInvalid(name, fmt::format("is of type '{}'; only flat pictures are read", header.type));
    const CompressionTraits& compression = requireCompression(header.compression, rules.limits, name);
    ExrLayout layout = checkWindow(header, rules.limits, name);
    const ChannelTotals totals = checkChannels(header, layout, rules.isPlain, name);
    const std::uint64_t pixels = layout.width * layout.height, channels = header.channels.size();
    layout.values = pixels * channels; // at most 2^28 bytes of header, 2^60 pixels
    if (pixels > rules.limits.maxValues / channels)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels of {} channels exceed {} values", name, layout.width,
                                layout.height, channels, rules.limits.maxValues));
    const std::uint64_t chunks =
        header.isTiled ? countTiles(header, layout, totals.bytesPerPixel, name)
                       : (layout.height + compression.rowsPerChunk - 1) / compression.rowsPerChunk;
    const std::uint64_t mostChunks = fileBytes / 8; // each has an offset in the file's table
    if (const auto& said = header.chunkCount;
        said && (*said < 0 || std::uint64_t(*said) < chunks || std::uint64_t(*said) > mostChunks))
        throwInvalid(name, fmt::format("header is damaged: {} chunks do not hold its {} x {} pixels", *said,
                                       layout.width, layout.height));
    if (chunks > mostChunks || totals.bytes / compression.maxRatio > fileBytes)
        throwInvalid(name,
                     fmt::format("is damaged or truncated: {} bytes cannot hold {} x {} pixels of {} bytes",
                                 fileBytes, layout.width, layout.height, totals.bytesPerPixel));
    return layout;
}

} // namespace rt
