#include "formats/image_exr.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/exr_header.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

namespace rt {
namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 28;
constexpr std::uint64_t kMaxSamples = std::uint64_t(1) << 31; // 8 GiB in memory
constexpr std::uint64_t kMaxTileBytes = std::uint64_t(1) << 28;

[[noreturn]] void throwInvalid(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::InvalidContent, name + ": " + what);
}

class InputBytes final : public Imf::IStream {
public:
    InputBytes(std::span<const std::byte> file, const std::vector<std::byte>& header, const std::string& name)
        : IStream(name.c_str()), file_(file), header_(header) {}

    bool read(char* to, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (count < 0 || at_ > file_.size() || size > file_.size() - at_)
            throw std::runtime_error("the file is truncated");
        const std::size_t fromHeader = at_ < header_.size() ? std::min(size, header_.size() - at_) : 0;
        if (fromHeader) std::memcpy(to, header_.data() + at_, fromHeader);
        if (size > fromHeader)
            std::memcpy(to + fromHeader, file_.data() + at_ + fromHeader, size - fromHeader);
        at_ += size;
        return at_ < file_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override { at_ = position; }

private:
    std::span<const std::byte> file_;
    const std::vector<std::byte>& header_;
    std::size_t at_ = 0;
};

// Bytes of memory that one byte of file can stand for, and rows per chunk. 0 = this compression is not read.
struct CompressionTraits {
    std::uint64_t maxRatio;
    std::uint64_t rowsPerChunk;
};

CompressionTraits traitsOf(Imf::Compression compression) {
    switch (compression) {
    case Imf::NO_COMPRESSION:
        return {1, 1};
    case Imf::RLE_COMPRESSION:
        return {64, 1}; // a run of 128 in two bytes
    case Imf::ZIPS_COMPRESSION:
        return {1032, 1}; // deflate: 258 bytes in two bits
    case Imf::ZIP_COMPRESSION:
        return {1032, 16};
    default:
        return {0, 0};
    }
}

std::string compressionName(Imf::Compression compression) {
    constexpr std::array<const char*, Imf::NUM_COMPRESSION_METHODS> kNames{
        "NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    const auto index = static_cast<std::size_t>(compression);
    return index < kNames.size() ? kNames[index] : fmt::format("number {}", index);
}

struct Layout {
    Imath::Box2i window;
    std::uint64_t width, height;
};

Layout checkWindow(const Imf::Header& header, const std::string& name) {
    const Imath::Box2i window = header.dataWindow();
    constexpr int kMaxCoordinate = 1 << 30;
    for (int value : {window.min.x, window.min.y, window.max.x, window.max.y})
        if (value < -kMaxCoordinate || value > kMaxCoordinate)
            throwInvalid(name, fmt::format("data window coordinate {} exceeds {}", value, kMaxCoordinate));
    if (window.max.x < window.min.x || window.max.y < window.min.y)
        throwInvalid(name, "data window is empty");
    const auto width = static_cast<std::uint64_t>(window.max.x - window.min.x) + 1;
    const auto height = static_cast<std::uint64_t>(window.max.y - window.min.y) + 1;
    if (width * height > kMaxPixels)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels exceed {}", name, width, height, kMaxPixels));
    return {window, width, height};
}

struct ChannelTotals {
    std::uint64_t count = 0;
    std::uint64_t bytesPerPixel = 0;
};

ChannelTotals checkChannels(const Imf::Header& header, const std::string& name) {
    ChannelTotals totals;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const Imf::Channel& channel = c.channel();
        if (channel.type != Imf::HALF && channel.type != Imf::FLOAT && channel.type != Imf::UINT)
            throwInvalid(name, fmt::format("channel {} has an unknown type", c.name()));
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throwInvalid(name, fmt::format("channel {} is subsampled {} x {}; convert the picture to R G B",
                                           c.name(), channel.xSampling, channel.ySampling));
        totals.count += 1;
        totals.bytesPerPixel += channel.type == Imf::HALF ? 2 : 4;
    }
    if (totals.count == 0) throwInvalid(name, "has no channels");
    return totals;
}

std::uint64_t checkTiles(const Imf::Header& header, const Layout& layout, std::uint64_t bytesPerPixel,
                         const std::string& name) {
    if (!header.hasTileDescription())
        throwInvalid(name, "header is damaged: tiled, but without a tile description");
    const Imf::TileDescription& tiles = header.tileDescription();
    if (tiles.xSize == 0 || tiles.ySize == 0 || tiles.mode >= Imf::NUM_LEVELMODES ||
        tiles.roundingMode >= Imf::NUM_ROUNDINGMODES)
        throwInvalid(name, "header is damaged: invalid tile description");
    if (std::uint64_t(tiles.xSize) * tiles.ySize > kMaxTileBytes / bytesPerPixel)
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: tiles of {} x {} pixels exceed {} bytes", name,
                                                          tiles.xSize, tiles.ySize, kMaxTileBytes));
    return (layout.width + tiles.xSize - 1) / tiles.xSize * ((layout.height + tiles.ySize - 1) / tiles.ySize);
}

// Refuses what is not supported, and sizes that a file of `fileBytes` cannot hold, before anything is
// allocated.
Layout checkHeader(const Imf::Header& header, bool tiled, std::uint64_t fileBytes, const std::string& name) {
    for (const char* required : {"channels", "compression", "dataWindow", "lineOrder"})
        if (header.find(required) == header.end())
            throwInvalid(name, fmt::format("header lacks '{}'", required));
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE)
        throwInvalid(name, fmt::format("is of type '{}'; only flat pictures are read", header.type()));
    const CompressionTraits traits = traitsOf(header.compression());
    if (traits.maxRatio == 0)
        throwInvalid(name, fmt::format("compression {} is not read; save it with NONE, RLE, ZIPS or ZIP",
                                       compressionName(header.compression())));
    const Layout layout = checkWindow(header, name);
    const auto [channelCount, bytesPerPixel] = checkChannels(header, name);
    const std::uint64_t pixels = layout.width * layout.height;
    if (pixels > kMaxSamples / channelCount)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels of {} channels exceed {} values", name, layout.width,
                                layout.height, channelCount, kMaxSamples));
    const std::uint64_t chunks = tiled ? checkTiles(header, layout, bytesPerPixel, name)
                                       : (layout.height + traits.rowsPerChunk - 1) / traits.rowsPerChunk;
    if (chunks > fileBytes / 8 || pixels * bytesPerPixel > fileBytes * traits.maxRatio)
        throwInvalid(name,
                     fmt::format("is damaged or truncated: {} bytes cannot hold {} x {} pixels of {} bytes",
                                 fileBytes, layout.width, layout.height, bytesPerPixel));
    return layout;
}

ImageChannel::Type typeFrom(Imf::PixelType type) {
    return type == Imf::HALF    ? ImageChannel::Type::Half
           : type == Imf::FLOAT ? ImageChannel::Type::Float
                                : ImageChannel::Type::Uint;
}

void readAttributes(const Imf::Header& header, Image& image) {
    for (auto a = header.begin(); a != header.end(); ++a) {
        const std::string key = a.name();
        if (key == "type" || key == "pixelAspectRatio" || key == "screenWindowWidth") continue; // structural
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            image.texts[key] = text->value();
        if (const auto* value = dynamic_cast<const Imf::FloatAttribute*>(&a.attribute()))
            image.floats[key] = value->value();
        if (const auto* value = dynamic_cast<const Imf::IntAttribute*>(&a.attribute()))
            image.ints[key] = value->value();
        if (const auto* m = dynamic_cast<const Imf::M44fAttribute*>(&a.attribute()))
            image.matrices[key].assign(&m->value()[0][0], &m->value()[0][0] + 16);
    }
}

// Allocates the channels of the header and points a frame buffer at them.
Imf::FrameBuffer allocateChannels(const Imf::Header& header, const Layout& layout, Image& image) {
    Imf::FrameBuffer frame;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        ImageChannel& channel = image.channels.emplace_back();
        channel.name = c.name();
        channel.type = typeFrom(c.channel().type);
        const bool isUint = channel.type == ImageChannel::Type::Uint;
        if (isUint)
            channel.uints.resize(image.pixelCount());
        else
            channel.values.resize(image.pixelCount());
        const void* data = isUint ? static_cast<const void*>(channel.uints.data()) : channel.values.data();
        frame.insert(channel.name, Imf::Slice::Make(isUint ? Imf::UINT : Imf::FLOAT, data, layout.window));
    }
    return frame;
}

void readPixels(Imf::MultiPartInputFile& file, bool tiled, const Layout& layout,
                const Imf::FrameBuffer& frame) {
    if (tiled) {
        Imf::TiledInputPart part(file, 0);
        part.setFrameBuffer(frame);
        part.readTiles(0, part.numXTiles(0) - 1, 0, part.numYTiles(0) - 1);
    } else {
        Imf::InputPart part(file, 0);
        part.setFrameBuffer(frame);
        part.readPixels(layout.window.min.y, layout.window.max.y);
    }
}

// Nothing if the data window is the display window, or if the latter says nothing of use.
std::optional<ImageFrame> frameOf(const Imf::Header& header, const Layout& layout) {
    if (header.find("displayWindow") == header.end()) return std::nullopt;
    const Imath::Box2i whole = header.displayWindow();
    constexpr int kMaxCoordinate = 1 << 30;
    for (int value : {whole.min.x, whole.min.y, whole.max.x, whole.max.y})
        if (value < -kMaxCoordinate || value > kMaxCoordinate) return std::nullopt;
    if (whole.max.x < whole.min.x || whole.max.y < whole.min.y || whole == layout.window) return std::nullopt;
    return ImageFrame{layout.window.min.x - whole.min.x, layout.window.min.y - whole.min.y,
                      static_cast<std::uint32_t>(whole.max.x - whole.min.x) + 1,
                      static_cast<std::uint32_t>(whole.max.y - whole.min.y) + 1};
}

Image decodeChecked(std::span<const std::byte> bytes, const std::string& name) {
    const std::vector<std::byte> safeHeader = safeExrHeader(bytes, name);
    InputBytes stream(bytes, safeHeader, name);
    constexpr std::uint64_t kAfterVersion = 8;
    stream.seekg(kAfterVersion);
    int version = std::to_integer<int>(bytes[4]) | std::to_integer<int>(bytes[5]) << 8;
    const bool tiled = (version & 0x200) != 0;
    Imf::Header header;
    header.readFrom(stream, version);
    const Layout layout = checkHeader(header, tiled, bytes.size(), name);

    stream.seekg(0);
    Imf::MultiPartInputFile file(stream, 0, false);
    if (!file.partComplete(0)) throwInvalid(name, "is truncated: some of its pixels are missing");
    Image image;
    image.width = static_cast<std::uint32_t>(layout.width);
    image.height = static_cast<std::uint32_t>(layout.height);
    image.frame = frameOf(header, layout);
    readAttributes(header, image);
    readPixels(file, tiled, layout, allocateChannels(header, layout, image));
    return image;
}

} // namespace

Image decodeExr(std::span<const std::byte> bytes, const std::string& name) {
    try {
        return decodeChecked(bytes, name);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) { // the library's own, of several types
        throwInvalid(name, fmt::format("is damaged: {}", error.what()));
    }
}

Image readExr(const std::string& path) {
    const std::string name = path == "-" ? "standard input" : path;
    const auto refuseOthers = [&](std::span<const std::byte> head) -> std::optional<std::uint64_t> {
        requireExrMagic(head, name);
        return std::nullopt;
    };
    return decodeExr(readFile(path, {kExrStartBytes, refuseOthers, {}}), name);
}

} // namespace rt
