#include "formats/image_exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace rt {
namespace {

class OutputBytes final : public Imf::OStream {
public:
    OutputBytes() : OStream("memory") {}
    void write(const char* from, int count) override {
        const std::size_t end = at_ + static_cast<std::size_t>(count);
        if (end > bytes.size()) bytes.resize(end);
        std::memcpy(bytes.data() + at_, from, static_cast<std::size_t>(count));
        at_ = end;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = position; }
    std::vector<std::byte> bytes;

private:
    std::size_t at_ = 0;
};

Imf::Header headerOf(const Image& image) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    if (image.frame) {
        const Imath::V2i first(image.frame->x, image.frame->y);
        const Imath::V2i whole(static_cast<int>(image.frame->width), static_cast<int>(image.frame->height));
        header.dataWindow() = {first, first + header.dataWindow().max};
        header.displayWindow() = {Imath::V2i(0), whole - Imath::V2i(1)};
    }
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities()); // the default is Rec. 709
    for (const auto& [key, value] : image.texts) header.insert(key, Imf::StringAttribute(value));
    for (const auto& [key, value] : image.floats) header.insert(key, Imf::FloatAttribute(value));
    for (const auto& [key, value] : image.ints) header.insert(key, Imf::IntAttribute(value));
    for (const auto& [key, value] : image.matrices) {
        if (value.size() != 16) throw std::logic_error("attribute " + key + " is not a 4x4 matrix");
        Imath::M44f matrix;
        std::copy(value.begin(), value.end(), &matrix[0][0]);
        header.insert(key, Imf::M44fAttribute(matrix));
    }
    return header;
}

// Finite values stay finite: half ends at 65504.
std::vector<Imath::half> toHalf(const std::vector<float>& values) {
    constexpr float kMaxHalf = 65504.0f;
    std::vector<Imath::half> halves;
    halves.reserve(values.size());
    for (float v : values) halves.emplace_back(std::isfinite(v) ? std::clamp(v, -kMaxHalf, kMaxHalf) : v);
    return halves;
}

} // namespace

std::vector<std::byte> encodeExr(const Image& image) {
    Imf::Header header = headerOf(image);
    Imf::FrameBuffer frame;
    std::vector<std::vector<Imath::half>> halves; // must outlive the writing
    for (const ImageChannel& channel : image.channels) {
        const bool isUint = channel.type == ImageChannel::Type::Uint;
        if ((isUint ? channel.uints.size() : channel.values.size()) != image.pixelCount())
            throw std::logic_error("channel " + channel.name + " does not have one value per pixel");
        Imf::PixelType type = isUint ? Imf::UINT : Imf::FLOAT;
        const void* data = isUint ? static_cast<const void*>(channel.uints.data()) : channel.values.data();
        if (channel.type == ImageChannel::Type::Half) {
            type = Imf::HALF;
            data = halves.emplace_back(toHalf(channel.values)).data();
        }
        header.channels().insert(channel.name, Imf::Channel(type));
        frame.insert(channel.name, Imf::Slice::Make(type, data, header.dataWindow()));
    }
    OutputBytes stream;
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(image.height));
    } // the destructor writes the table of offsets
    return std::move(stream.bytes);
}

} // namespace rt
