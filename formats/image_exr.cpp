#include "formats/image_exr.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/exr_header.h"
#include "formats/exr_layout.h"

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
#include <cstring>
#include <new>
#include <stdexcept>

namespace rt {
namespace {

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

std::optional<ImageChannel::Type> typeFrom(Imf::PixelType type) {
    switch (type) {
    case Imf::HALF:
        return ImageChannel::Type::Half;
    case Imf::FLOAT:
        return ImageChannel::Type::Float;
    case Imf::UINT:
        return ImageChannel::Type::Uint;
    default:
        return std::nullopt;
    }
}

// Throws unless the header has what every part must have.
ExrPartHeader plainHeader(const Imf::Header& header, bool isTiled, const std::string& name) {
    for (const char* required : {"channels", "compression", "dataWindow", "lineOrder"})
        if (header.find(required) == header.end())
            throwInvalid(name, fmt::format("header lacks '{}'", required));
    static_assert(Imf::ZIP_COMPRESSION == 3 && Imf::DWAB_COMPRESSION == 9, "as files number them");
    const Imath::Box2i& window = header.dataWindow();
    ExrPartHeader plain;
    plain.type = header.hasType() ? header.type() : "";
    plain.compression = static_cast<std::size_t>(header.compression());
    plain.minX = window.min.x;
    plain.minY = window.min.y;
    plain.maxX = window.max.x;
    plain.maxY = window.max.y;
    plain.isTiled = isTiled;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        plain.channels.push_back(
            {c.name(), typeFrom(c.channel().type), c.channel().xSampling, c.channel().ySampling});
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tiles = header.tileDescription();
        plain.tiles = {tiles.xSize, tiles.ySize,
                       tiles.mode < Imf::NUM_LEVELMODES && tiles.roundingMode < Imf::NUM_ROUNDINGMODES};
    }
    if (header.hasChunkCount()) plain.chunkCount = header.chunkCount();
    return plain;
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

// A part whose header was found good.
struct CheckedPart {
    Imf::Header header;
    ExrPartHeader plain;
    ExrLayout layout;
};

// One value for each block of pixels becomes one for each pixel.
template <class T>
void repeatInBlocks(std::vector<T>& values, const ExrLayout& layout, const ExrPartHeader::Channel& channel) {
    const std::uint64_t blockWidth = std::uint64_t(channel.xSampling),
                        blockHeight = std::uint64_t(channel.ySampling);
    const std::vector<T> blocks = std::move(values);
    values.resize(layout.width * layout.height);
    for (std::uint64_t y = 0, i = 0; y < layout.height; ++y)
        for (std::uint64_t x = 0; x < layout.width; ++x, ++i)
            values[i] = blocks[y / blockHeight * (layout.width / blockWidth) + x / blockWidth];
}

// Allocates the channels of the part and points a frame buffer at them.
Imf::FrameBuffer allocateChannels(const CheckedPart& part, Image& image) {
    Imf::FrameBuffer frame;
    for (const ExrPartHeader::Channel& source : part.plain.channels) {
        ImageChannel& channel = image.channels.emplace_back();
        channel.name = source.name;
        channel.type = source.type.value();
        const bool isUint = channel.type == ImageChannel::Type::Uint;
        const std::size_t blocks = (part.layout.width / std::uint64_t(source.xSampling)) *
                                   (part.layout.height / std::uint64_t(source.ySampling));
        if (isUint)
            channel.uints.resize(blocks);
        else
            channel.values.resize(blocks);
        const void* data = isUint ? static_cast<const void*>(channel.uints.data()) : channel.values.data();
        frame.insert(channel.name,
                     Imf::Slice::Make(isUint ? Imf::UINT : Imf::FLOAT, data, part.header.dataWindow(), 0, 0,
                                      source.xSampling, source.ySampling));
    }
    return frame;
}

// What is left if these rows alone are wanted.
CheckedPart cutToRows(CheckedPart part, const ExrRowRange& rows, const std::string& name) {
    if (part.plain.isTiled) throwInvalid(name, "holds tiles; pictures of rows are wanted");
    if (rows.first > part.layout.height || rows.count > part.layout.height - rows.first)
        throw std::logic_error("rows beyond the picture");
    part.plain.minY += static_cast<int>(rows.first);
    part.plain.maxY = part.plain.minY + static_cast<int>(rows.count) - 1;
    part.header.dataWindow().min.y = part.plain.minY;
    part.header.dataWindow().max.y = part.plain.maxY;
    part.layout.height = rows.count;
    return part;
}

void readPixels(Imf::MultiPartInputFile& file, int index, const CheckedPart& part, Image& image) {
    const Imf::FrameBuffer frame = allocateChannels(part, image);
    if (part.plain.isTiled) {
        Imf::TiledInputPart input(file, index);
        input.setFrameBuffer(frame);
        input.readTiles(0, input.numXTiles(0) - 1, 0, input.numYTiles(0) - 1);
    } else {
        Imf::InputPart input(file, index);
        input.setFrameBuffer(frame);
        if (part.layout.height > 0) input.readPixels(part.plain.minY, part.plain.maxY);
    }
    for (std::size_t c = 0; c < image.channels.size(); ++c) {
        const ExrPartHeader::Channel& source = part.plain.channels[c];
        ImageChannel& channel = image.channels[c];
        if (source.isFull()) continue;
        if (channel.type == ImageChannel::Type::Uint)
            repeatInBlocks(channel.uints, part.layout, source);
        else
            repeatInBlocks(channel.values, part.layout, source);
    }
}

PixelBox boxOf(const Imath::Box2i& window) {
    return {window.min.x, window.min.y, window.max.x + 1, window.max.y + 1};
}

// The data window if the header has no display window, or one that says nothing of use.
PixelBox displayWindowOf(const Imf::Header& header) {
    const PixelBox data = boxOf(header.dataWindow());
    if (header.find("displayWindow") == header.end()) return data;
    const Imath::Box2i whole = header.displayWindow();
    constexpr int kMaxCoordinate = 1 << 30;
    for (int value : {whole.min.x, whole.min.y, whole.max.x, whole.max.y})
        if (value < -kMaxCoordinate || value > kMaxCoordinate) return data;
    return whole.max.x < whole.min.x || whole.max.y < whole.min.y ? data : boxOf(whole);
}

PicturePart readPart(Imf::MultiPartInputFile& file, int index, const CheckedPart& checked,
                     const std::optional<ExrRowRange>& rows, const std::string& name) {
    if (!file.partComplete(index)) throwInvalid(name, "is truncated: some of its pixels are missing");
    const Imf::Header& header = checked.header;
    PicturePart part;
    if (header.hasName()) part.name = header.name();
    part.dataWindow = boxOf(header.dataWindow());
    part.displayWindow = displayWindowOf(header);
    readCamera(header, part);
    if (header.find("pixelAspectRatio") != header.end()) part.pixelAspect = header.pixelAspectRatio();
    if (const auto* found = header.findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities")) {
        const Imf::Chromaticities& c = found->value();
        part.chromaticities = {c.red.x,  c.red.y,  c.green.x, c.green.y,
                               c.blue.x, c.blue.y, c.white.x, c.white.y};
    }
    part.image.width = part.dataWindow.width();
    part.image.height = part.dataWindow.height();
    readAttributes(header, part.image);
    readPixels(file, index, rows ? cutToRows(checked, *rows, name) : checked, part.image);
    return part;
}

std::vector<CheckedPart> checkParts(std::span<const std::byte> bytes, const SafeExrHeader& safe,
                                    InputBytes& stream, const std::string& name, const ExrRules& rules) {
    stream.seekg(kExrStartBytes);
    int version = std::to_integer<int>(bytes[4]) | std::to_integer<int>(bytes[5]) << 8;
    std::vector<CheckedPart> parts(safe.parts);
    std::uint64_t values = 0;
    for (CheckedPart& part : parts) {
        part.header.readFrom(stream, version);
        const bool isTiled = safe.multiPart ? part.header.hasType() && part.header.type() == Imf::TILEDIMAGE
                                            : (version & 0x200) != 0;
        part.plain = plainHeader(part.header, isTiled, name);
        part.layout = checkExrLayout(part.plain, rules, bytes.size(), name);
        values += part.layout.values;
    }
    if (values > rules.limits.maxValues)
        throw Error(ErrorKind::LimitExceeded, fmt::format("{}: {} values in {} parts exceed {}", name, values,
                                                          safe.parts, rules.limits.maxValues));
    return parts;
}

std::vector<PicturePart> decodeChecked(std::span<const std::byte> bytes, const std::string& name,
                                       const ExrRules& rules, const std::optional<ExrRowRange>& rows) {
    const SafeExrHeader safe = safeExrHeader(bytes, name, !rules.isPlain);
    InputBytes stream(bytes, safe.bytes, name);
    const std::vector<CheckedPart> checked = checkParts(bytes, safe, stream, name, rules);
    stream.seekg(0);
    Imf::MultiPartInputFile file(stream, 0, false);
    std::vector<PicturePart> parts;
    for (const CheckedPart& part : checked)
        parts.push_back(readPart(file, static_cast<int>(parts.size()), part, rows, name));
    return parts;
}

std::vector<PicturePart> decodeParts(std::span<const std::byte> bytes, const std::string& name,
                                     const ExrRules& rules, const std::optional<ExrRowRange>& rows = {}) {
    try {
        return decodeChecked(bytes, name, rules, rows);
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
    PicturePart part = std::move(decodeParts(bytes, name, {{}, true}, ExrRowRange{}).front());
    part.image.frame = frameOf(part);
    return std::move(part.image);
}

Image decodeExrRows(std::span<const std::byte> bytes, const std::string& name, const ExrRowRange& rows) {
    PicturePart part = std::move(decodeParts(bytes, name, {{}, true}, rows).front());
    part.image.frame = frameOf(part);
    part.image.frame->y += static_cast<std::int32_t>(rows.first);
    part.image.height = rows.count;
    return std::move(part.image);
}

Image readExr(const std::string& path) {
    const std::string name = inputName(path);
    const auto refuseOthers = [&](std::span<const std::byte> head) -> std::optional<std::uint64_t> {
        requireExrMagic(head, name);
        return std::nullopt;
    };
    return decodeExr(readFile(path, {kExrStartBytes, refuseOthers, {}}), name);
}

} // namespace rt
