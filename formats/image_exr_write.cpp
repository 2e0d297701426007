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
#include <optional>
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

Imf::PixelType typeOf(const ImageChannel& channel) {
    return channel.type == ImageChannel::Type::Uint   ? Imf::UINT
           : channel.type == ImageChannel::Type::Half ? Imf::HALF
                                                      : Imf::FLOAT;
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

struct ExrEncoder::State {
    explicit State(const Image& image) : header(headerOf(image)), channels(image.channels.size()) {
        for (const ImageChannel& channel : image.channels)
            header.channels().insert(channel.name, Imf::Channel(typeOf(channel)));
        next = header.dataWindow().min.y;
        file.emplace(stream, header, 0);
    }

    Imf::Header header;
    std::size_t channels;
    int next = 0; // row
    OutputBytes stream;
    std::optional<Imf::OutputFile> file; // its destructor writes the table of offsets
};

ExrEncoder::ExrEncoder(const Image& header) : state_(std::make_unique<State>(header)) {}
ExrEncoder::~ExrEncoder() = default;

void ExrEncoder::add(const Image& rows) {
    Imath::Box2i window = state_->header.dataWindow();
    if (rows.channels.size() != state_->channels ||
        rows.width != static_cast<std::uint32_t>(window.max.x - window.min.x) + 1)
        throw std::logic_error("rows of another picture");
    window.min.y = state_->next;
    window.max.y = state_->next + static_cast<int>(rows.height) - 1;
    Imf::FrameBuffer frame;
    std::vector<std::vector<Imath::half>> halves; // must outlive the writing
    for (const ImageChannel& channel : rows.channels) {
        const bool isUint = channel.type == ImageChannel::Type::Uint;
        if ((isUint ? channel.uints.size() : channel.values.size()) != rows.pixelCount())
            throw std::logic_error("channel " + channel.name + " does not have one value per pixel");
        const void* data = isUint ? static_cast<const void*>(channel.uints.data()) : channel.values.data();
        if (channel.type == ImageChannel::Type::Half)
            data = halves.emplace_back(toHalf(channel.values)).data();
        frame.insert(channel.name, Imf::Slice::Make(typeOf(channel), data, window));
    }
    state_->file->setFrameBuffer(frame);
    state_->file->writePixels(static_cast<int>(rows.height));
    state_->next += static_cast<int>(rows.height);
}

std::vector<std::byte> ExrEncoder::finish() {
    state_->file.reset();
    return std::move(state_->stream.bytes);
}

std::vector<std::byte> encodeExr(const Image& image) {
    ExrEncoder encoder(image);
    encoder.add(image);
    return encoder.finish();
}

} // namespace rt
