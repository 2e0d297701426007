#include "formats/image_exr.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/exr_header.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
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
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

namespace rt {
namespace {

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

// Bytes of memory that one byte of file can stand for, and rows per chunk.
struct CompressionTraits {
    std::uint64_t maxRatio = 0; // 0: no such compression
    std::uint64_t rowsPerChunk = 1;
    bool isSafe = true; // no decoder of Debian's library has known holes
};

CompressionTraits traitsOf(Imf::Compression compression) {
    constexpr std::uint64_t kUnknownRatio = 1 << 16; // several stages, each of which shortens runs
    switch (compression) {
    case Imf::NO_COMPRESSION:
        return {1, 1};
    case Imf::RLE_COMPRESSION:
        return {64, 1}; // a run of 128 in two bytes
    case Imf::ZIPS_COMPRESSION:
        return {1032, 1}; // deflate: 258 bytes in two bits
    case Imf::ZIP_COMPRESSION:
        return {1032, 16};
    case Imf::PXR24_COMPRESSION:
        return {kUnknownRatio, 16, false};
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
        return {kUnknownRatio, 32, false};
    case Imf::DWAB_COMPRESSION:
        return {kUnknownRatio, 256, false};
    default:
        return {};
    }
}

std::string compressionName(Imf::Compression compression) {
    constexpr std::array<const char*, Imf::NUM_COMPRESSION_METHODS> kNames{
        "NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    const auto index = static_cast<std::size_t>(compression);
    return index < kNames.size() ? kNames[index] : fmt::format("number {}", index);
}

struct ReadRules {
    PictureLimits limits;
    bool isPlain = false;                 // one part, whose channels all have the full size
    std::optional<ExrRowRange> rows = {}; // of scanlines; else all
};

struct Layout {
    Imath::Box2i window;
    std::uint64_t width, height;
    std::uint64_t values; // pixels times channels
    bool isTiled;
};

Layout checkWindow(const Imf::Header& header, const PictureLimits& limits, const std::string& name) {
    const Imath::Box2i window = header.dataWindow();
    constexpr int kMaxCoordinate = 1 << 30;
    for (int value : {window.min.x, window.min.y, window.max.x, window.max.y})
        if (value < -kMaxCoordinate || value > kMaxCoordinate)
            throwInvalid(name, fmt::format("data window coordinate {} exceeds {}", value, kMaxCoordinate));
    if (window.max.x < window.min.x || window.max.y < window.min.y)
        throwInvalid(name, "data window is empty");
    const auto width = static_cast<std::uint64_t>(window.max.x - window.min.x) + 1;
    const auto height = static_cast<std::uint64_t>(window.max.y - window.min.y) + 1;
    if (width * height > limits.maxPixels)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels exceed {}", name, width, height, limits.maxPixels));
    return {window, width, height, 0, false};
}

struct ChannelTotals {
    std::uint64_t count = 0;
    std::uint64_t bytesPerPixel = 0; // of all channels at their full size
    std::uint64_t bytes = 0;
};

// Channels of less than the full size must fill whole blocks of pixels, as the library wants it.
void checkSampling(const char* channelName, const Imf::Channel& channel, const Layout& layout, bool isPlain,
                   const std::string& name) {
    if (channel.xSampling == 1 && channel.ySampling == 1) return;
    const std::string found =
        fmt::format("channel {} is subsampled {} x {}", channelName, channel.xSampling, channel.ySampling);
    if (isPlain) throwInvalid(name, found + "; convert the picture to R G B");
    const Imath::V2i corner = layout.window.min;
    if (layout.isTiled || channel.xSampling < 1 || channel.ySampling < 1 ||
        corner.x % channel.xSampling != 0 || corner.y % channel.ySampling != 0 ||
        layout.width % std::uint64_t(channel.xSampling) != 0 ||
        layout.height % std::uint64_t(channel.ySampling) != 0)
        throwInvalid(name, "header is damaged: " + found + ", which does not fit its data window");
}

ChannelTotals checkChannels(const Imf::Header& header, const Layout& layout, bool isPlain,
                            const std::string& name) {
    ChannelTotals totals;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const Imf::Channel& channel = c.channel();
        if (channel.type != Imf::HALF && channel.type != Imf::FLOAT && channel.type != Imf::UINT)
            throwInvalid(name, fmt::format("channel {} has an unknown type", c.name()));
        checkSampling(c.name(), channel, layout, isPlain, name);
        const std::uint64_t bytes = channel.type == Imf::HALF ? 2 : 4;
        totals.count += 1;
        totals.bytesPerPixel += bytes;
        totals.bytes += bytes * (layout.width / std::uint64_t(channel.xSampling)) *
                        (layout.height / std::uint64_t(channel.ySampling));
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
Layout checkHeader(const Imf::Header& header, bool isTiled, const ReadRules& rules, std::uint64_t fileBytes,
                   const std::string& name) {
    for (const char* required : {"channels", "compression", "dataWindow", "lineOrder"})
        if (header.find(required) == header.end())
            throwInvalid(name, fmt::format("header lacks '{}'", required));
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE)
        throwInvalid(name, fmt::format("is of type '{}'; only flat pictures are read", header.type()));
    const CompressionTraits traits = traitsOf(header.compression());
    if (traits.maxRatio == 0 || (!traits.isSafe && !rules.limits.allCompressions))
        throwInvalid(name, fmt::format("compression {} is not read; save it with NONE, RLE, ZIPS or ZIP{}",
                                       compressionName(header.compression()),
                                       rules.limits.allCompressionsOption.empty() || traits.maxRatio == 0
                                           ? ""
                                           : ", or trust it with " + rules.limits.allCompressionsOption));
    Layout layout = checkWindow(header, rules.limits, name);
    layout.isTiled = isTiled;
    const ChannelTotals totals = checkChannels(header, layout, rules.isPlain, name);
    const std::uint64_t pixels = layout.width * layout.height;
    layout.values = pixels * totals.count; // at most 2^28 bytes of header, 2^60 pixels
    if (pixels > rules.limits.maxValues / totals.count)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {} x {} pixels of {} channels exceed {} values", name, layout.width,
                                layout.height, totals.count, rules.limits.maxValues));
    const std::uint64_t chunks = isTiled ? checkTiles(header, layout, totals.bytesPerPixel, name)
                                         : (layout.height + traits.rowsPerChunk - 1) / traits.rowsPerChunk;
    if (header.hasChunkCount() && (header.chunkCount() < 0 || std::uint64_t(header.chunkCount()) < chunks ||
                                   std::uint64_t(header.chunkCount()) > fileBytes / 8))
        throwInvalid(name, fmt::format("header is damaged: {} chunks do not hold its {} x {} pixels",
                                       header.chunkCount(), layout.width, layout.height));
    if (chunks > fileBytes / 8 || totals.bytes / traits.maxRatio > fileBytes)
        throwInvalid(name,
                     fmt::format("is damaged or truncated: {} bytes cannot hold {} x {} pixels of {} bytes",
                                 fileBytes, layout.width, layout.height, totals.bytesPerPixel));
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
        if (key == "type" || key == "name" || key == "chunkCount" || key == "pixelAspectRatio" ||
            key == "screenWindowWidth")
            continue; // structural
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            image.texts[key] = text->value();
        if (const auto* value = dynamic_cast<const Imf::FloatAttribute*>(&a.attribute()))
            image.floats[key] = value->value();
        if (const auto* value = dynamic_cast<const Imf::IntAttribute*>(&a.attribute()))
            image.ints[key] = value->value();
        if (const auto* m = dynamic_cast<const Imf::M44fAttribute*>(&a.attribute()))
            image.matrices[key].assign(&m->value()[0][0], &m->value()[0][0] + 16);
        if (const auto* d = dynamic_cast<const Imf::M44dAttribute*>(&a.attribute())) {
            const Imath::M44f m(d->value());
            image.matrices[key].assign(&m[0][0], &m[0][0] + 16);
        }
    }
}

void readCamera(const Imf::Header& header, PicturePart& part) {
    if (const auto* width = header.findTypedAttribute<Imf::FloatAttribute>("screenWindowWidth"))
        part.camera["screenWindowWidth"] = fmt::format("{}", width->value());
    if (const auto* center = header.findTypedAttribute<Imf::V2fAttribute>("screenWindowCenter"))
        part.camera["screenWindowCenter"] = fmt::format("{} {}", center->value().x, center->value().y);
    if (const auto* view = header.findTypedAttribute<Imf::StringAttribute>("view"))
        part.camera["view"] = view->value();
    if (const auto* map = header.findTypedAttribute<Imf::EnvmapAttribute>("envmap"))
        part.camera["envmap"] = map->value() == Imf::ENVMAP_CUBE ? "cube" : "latlong";
}

// One value for each block of pixels becomes one for each pixel.
template <class T>
void repeatInBlocks(std::vector<T>& values, const Layout& layout, const Imf::Channel& channel) {
    const std::uint64_t blockWidth = std::uint64_t(channel.xSampling),
                        blockHeight = std::uint64_t(channel.ySampling);
    const std::vector<T> blocks = std::move(values);
    values.resize(layout.width * layout.height);
    for (std::uint64_t y = 0, i = 0; y < layout.height; ++y)
        for (std::uint64_t x = 0; x < layout.width; ++x, ++i)
            values[i] = blocks[y / blockHeight * (layout.width / blockWidth) + x / blockWidth];
}

// Allocates the channels of the header and points a frame buffer at them.
Imf::FrameBuffer allocateChannels(const Imf::Header& header, const Layout& layout, Image& image) {
    Imf::FrameBuffer frame;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const Imf::Channel& source = c.channel();
        ImageChannel& channel = image.channels.emplace_back();
        channel.name = c.name();
        channel.type = typeFrom(source.type);
        const bool isUint = channel.type == ImageChannel::Type::Uint;
        const std::size_t blocks = (layout.width / std::uint64_t(source.xSampling)) *
                                   (layout.height / std::uint64_t(source.ySampling));
        if (isUint)
            channel.uints.resize(blocks);
        else
            channel.values.resize(blocks);
        const void* data = isUint ? static_cast<const void*>(channel.uints.data()) : channel.values.data();
        frame.insert(channel.name, Imf::Slice::Make(isUint ? Imf::UINT : Imf::FLOAT, data, layout.window, 0,
                                                    0, source.xSampling, source.ySampling));
    }
    return frame;
}

// What is left if these rows alone are wanted.
Layout cutToRows(Layout layout, const ExrRowRange& rows, const std::string& name) {
    if (layout.isTiled) throwInvalid(name, "holds tiles; pictures of rows are wanted");
    if (rows.first > layout.height || rows.count > layout.height - rows.first)
        throw std::logic_error("rows beyond the picture");
    layout.window.min.y += static_cast<int>(rows.first);
    layout.window.max.y = layout.window.min.y + static_cast<int>(rows.count) - 1;
    layout.height = rows.count;
    return layout;
}

void readPixels(Imf::MultiPartInputFile& file, int part, const Layout& layout,
                const Imf::FrameBuffer& frame) {
    if (layout.isTiled) {
        Imf::TiledInputPart input(file, part);
        input.setFrameBuffer(frame);
        input.readTiles(0, input.numXTiles(0) - 1, 0, input.numYTiles(0) - 1);
    } else {
        Imf::InputPart input(file, part);
        input.setFrameBuffer(frame);
        input.readPixels(layout.window.min.y, layout.window.max.y);
    }
}

PixelBox boxOf(const Imath::Box2i& window) {
    return {window.min.x, window.min.y, window.max.x + 1, window.max.y + 1};
}

// The data window if the header has no display window, or one that says nothing of use.
PixelBox displayWindowOf(const Imf::Header& header, const Layout& layout) {
    if (header.find("displayWindow") == header.end()) return boxOf(layout.window);
    const Imath::Box2i whole = header.displayWindow();
    constexpr int kMaxCoordinate = 1 << 30;
    for (int value : {whole.min.x, whole.min.y, whole.max.x, whole.max.y})
        if (value < -kMaxCoordinate || value > kMaxCoordinate) return boxOf(layout.window);
    return whole.max.x < whole.min.x || whole.max.y < whole.min.y ? boxOf(layout.window) : boxOf(whole);
}

PicturePart readPart(Imf::MultiPartInputFile& file, int index, const Imf::Header& header, Layout layout,
                     const ReadRules& rules, const std::string& name) {
    if (!file.partComplete(index)) throwInvalid(name, "is truncated: some of its pixels are missing");
    PicturePart part;
    if (header.hasName()) part.name = header.name();
    part.displayWindow = displayWindowOf(header, layout);
    part.dataWindow = boxOf(layout.window);
    readCamera(header, part);
    if (header.find("pixelAspectRatio") != header.end()) part.pixelAspect = header.pixelAspectRatio();
    if (const auto* found = header.findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities")) {
        const Imf::Chromaticities& c = found->value();
        part.chromaticities = {c.red.x,  c.red.y,  c.green.x, c.green.y,
                               c.blue.x, c.blue.y, c.white.x, c.white.y};
    }
    Image& image = part.image;
    image.width = static_cast<std::uint32_t>(layout.width);
    image.height = static_cast<std::uint32_t>(layout.height);
    readAttributes(header, image);
    if (rules.rows) layout = cutToRows(layout, *rules.rows, name);
    const Imf::FrameBuffer frame = allocateChannels(header, layout, image);
    if (layout.height > 0) readPixels(file, index, layout, frame);
    std::size_t i = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++i) {
        if (c.channel().xSampling == 1 && c.channel().ySampling == 1) continue;
        ImageChannel& channel = image.channels[i];
        if (channel.type == ImageChannel::Type::Uint)
            repeatInBlocks(channel.uints, layout, c.channel());
        else
            repeatInBlocks(channel.values, layout, c.channel());
    }
    return part;
}

std::vector<PicturePart> decodeChecked(std::span<const std::byte> bytes, const std::string& name,
                                       const ReadRules& rules) {
    const SafeExrHeader safe = safeExrHeader(bytes, name, !rules.isPlain);
    InputBytes stream(bytes, safe.bytes, name);
    stream.seekg(kExrStartBytes);
    int version = std::to_integer<int>(bytes[4]) | std::to_integer<int>(bytes[5]) << 8;
    std::vector<Imf::Header> headers(safe.parts);
    std::vector<Layout> layouts;
    std::uint64_t values = 0;
    for (Imf::Header& header : headers) {
        header.readFrom(stream, version);
        const bool isTiled =
            safe.multiPart ? header.hasType() && header.type() == Imf::TILEDIMAGE : (version & 0x200) != 0;
        layouts.push_back(checkHeader(header, isTiled, rules, bytes.size(), name));
        values += layouts.back().values;
    }
    if (values > rules.limits.maxValues)
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: {} values in {} parts exceed {}", name, values,
                                                          safe.parts, rules.limits.maxValues));
    stream.seekg(0);
    Imf::MultiPartInputFile file(stream, 0, false);
    std::vector<PicturePart> parts;
    for (std::size_t i = 0; i < headers.size(); ++i)
        parts.push_back(readPart(file, static_cast<int>(i), headers[i], layouts[i], rules, name));
    return parts;
}

std::vector<PicturePart> decodeParts(std::span<const std::byte> bytes, const std::string& name,
                                     const ReadRules& rules) {
    try {
        return decodeChecked(bytes, name, rules);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) { // the library's own, of several types
        throwInvalid(name, fmt::format("is damaged: {}", error.what()));
    }
}

ImageFrame frameOf(const PicturePart& part) {
    const PixelBox data = part.dataWindow, whole = part.displayWindow;
    return {data.x0 - whole.x0, data.y0 - whole.y0, whole.width(), whole.height()};
}

} // namespace

std::vector<PicturePart> decodeExrParts(std::span<const std::byte> bytes, const std::string& name,
                                        const PictureLimits& limits) {
    return decodeParts(bytes, name, {limits, false});
}

Image decodeExr(std::span<const std::byte> bytes, const std::string& name) {
    PicturePart part = std::move(decodeParts(bytes, name, {{}, true}).front());
    if (part.dataWindow != part.displayWindow) part.image.frame = frameOf(part);
    return std::move(part.image);
}

Image decodeExrHeader(std::span<const std::byte> bytes, const std::string& name) {
    PicturePart part = std::move(decodeParts(bytes, name, {{}, true, ExrRowRange{}}).front());
    part.image.frame = frameOf(part);
    return std::move(part.image);
}

Image decodeExrRows(std::span<const std::byte> bytes, const std::string& name, const ExrRowRange& rows) {
    PicturePart part = std::move(decodeParts(bytes, name, {{}, true, rows}).front());
    part.image.frame = frameOf(part);
    part.image.frame->y += static_cast<std::int32_t>(rows.first);
    part.image.height = rows.count;
    return std::move(part.image);
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
