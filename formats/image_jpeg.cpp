#include "formats/image_jpeg.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
// jpeglib.h needs FILE and size_t
#include <jpeglib.h>

namespace rt {
namespace {

// A progressive file may repeat scans for ever; real ones have about ten.
constexpr int kMaxScans = 500;

struct Decoder {
    jpeg_decompress_struct info{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    std::jmp_buf leave{};
    char message[JMSG_LENGTH_MAX] = {};
};

// The library leaves by longjmp: nothing that has a destructor may live in the functions below it.
[[noreturn]] void onError(j_common_ptr common) {
    auto* decoder = static_cast<Decoder*>(common->client_data);
    common->err->format_message(common, decoder->message);
    std::longjmp(decoder->leave, 1);
}

void onMessage(j_common_ptr common, int level) {
    if (level < 0) onError(common); // a warning: the data is corrupt
}

void onProgress(j_common_ptr common) {
    auto* decoder = static_cast<Decoder*>(common->client_data);
    if (decoder->info.input_scan_number <= kMaxScans) return;
    std::snprintf(decoder->message, sizeof decoder->message, "it has more than %d scans", kMaxScans);
    std::longjmp(decoder->leave, 1);
}

// False if the library found a fault; Decoder::message says which.
bool readHeader(Decoder& decoder, std::span<const std::byte> bytes) {
    if (setjmp(decoder.leave)) return false;
    jpeg_create_decompress(&decoder.info);
    decoder.info.client_data = &decoder; // the call before clears it
    decoder.info.progress = &decoder.progress;
    jpeg_mem_src(&decoder.info, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&decoder.info, TRUE);
    const J_COLOR_SPACE stored = decoder.info.jpeg_color_space;
    decoder.info.out_color_space = stored == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
    decoder.info.dct_method = JDCT_ISLOW;
    return true;
}

bool readRows(Decoder& decoder, unsigned char* pixels) {
    if (setjmp(decoder.leave)) return false;
    jpeg_start_decompress(&decoder.info);
    const std::size_t rowBytes =
        std::size_t(decoder.info.output_width) * unsigned(decoder.info.output_components);
    while (decoder.info.output_scanline < decoder.info.output_height) {
        JSAMPROW row = pixels + rowBytes * decoder.info.output_scanline;
        jpeg_read_scanlines(&decoder.info, &row, 1);
    }
    jpeg_finish_decompress(&decoder.info);
    return true;
}

class JpegReader {
public:
    JpegReader(std::span<const std::byte> bytes, const std::string& name) : name_(name) {
        decoder_.info.err = jpeg_std_error(&decoder_.errors);
        decoder_.errors.error_exit = onError;
        decoder_.errors.emit_message = onMessage;
        decoder_.progress.progress_monitor = onProgress;
        decoder_.info.client_data = &decoder_;
        if (!readHeader(decoder_, bytes)) {
            jpeg_destroy_decompress(&decoder_.info);
            throwDamaged();
        }
    }
    ~JpegReader() { jpeg_destroy_decompress(&decoder_.info); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    const jpeg_decompress_struct& info() const { return decoder_.info; }

    std::vector<unsigned char> pixels() {
        std::vector<unsigned char> bytes(std::size_t(info().image_width) * info().image_height * channels());
        if (!readRows(decoder_, bytes.data())) throwDamaged();
        return bytes;
    }
    std::size_t channels() const { return info().out_color_space == JCS_GRAYSCALE ? 1 : 3; }

private:
    [[noreturn]] void throwDamaged() const {
        throw Error(ErrorKind::InvalidContent, fmt::format("{}: is damaged: {}", name_, decoder_.message));
    }

    const std::string& name_;
    Decoder decoder_;
};

} // namespace

Picture decodeJpeg(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
    JpegReader reader(bytes, name);
    const std::uint32_t width = reader.info().image_width, height = reader.info().image_height;
    if (reader.info().num_components != 1 && reader.info().num_components != 3)
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: has {} components; only grey and RGB are read", name,
                                reader.info().num_components));
    const std::size_t channels = reader.channels();
    requirePixels(width, height, limits.maxPixelsOf(channels), name);
    constexpr std::uint64_t kPixelsPerByte = 1024; // at most: a block of 8x8 takes a bit for its mean alone
    if (std::uint64_t(width) * height / kPixelsPerByte > bytes.size())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged or truncated: {} bytes cannot hold {} x {} pixels", name,
                                bytes.size(), width, height));
    const std::vector<unsigned char> pixels = reader.pixels();
    Picture picture = singlePartPicture(
        name, "JPEG", ValueScale::Display,
        imageOfPixels(width, height, channels == 1 ? "Y" : "RGB",
                      [&](std::size_t x, std::size_t y, std::size_t c) {
                          return static_cast<float>(pixels[(y * width + x) * channels + c]) / 255.0f;
                      }));
    if (reader.info().saw_JFIF_marker && reader.info().X_density > 0 && reader.info().Y_density > 0)
        picture.parts.front().pixelAspect = float(reader.info().Y_density) / float(reader.info().X_density);
    return picture;
}

} // namespace rt
