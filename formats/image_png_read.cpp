#include "common/error.h"
#include "formats/image_png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>

namespace rt {
namespace {

struct Source {
    std::span<const std::byte> rest;
    char message[160] = {};
};

// The library leaves by longjmp: nothing that has a destructor may live in the functions below it.
[[noreturn]] void onError(png_structp png, png_const_charp message) {
    auto* source = static_cast<Source*>(png_get_error_ptr(png));
    std::strncpy(source->message, message, sizeof source->message - 1);
    std::longjmp(*png_set_longjmp_fn(png, std::longjmp, sizeof(std::jmp_buf)), 1);
}

void onWarning(png_structp, png_const_charp) {} // of what does not change the pixels

void take(png_structp png, png_bytep to, std::size_t count) {
    auto* source = static_cast<Source*>(png_get_io_ptr(png));
    if (count > source->rest.size()) png_error(png, "the file is truncated");
    std::memcpy(to, source->rest.data(), count);
    source->rest = source->rest.subspan(count);
}

struct PngInfo {
    png_uint_32 width = 0, height = 0;
    int bits = 0, channels = 0;
    float pixelAspect = 1.0f;
    bool hasChromaticities = false;
    double chromaticities[8] = {}; // white, red, green, blue
};

// False if the library found a fault; Source::message says which.
bool readInfo(png_structp png, png_infop info, PngInfo& result) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_info(png, info);
    png_set_expand(png); // palettes, grey of less than 8 bits, and transparent colours
    if (png_get_bit_depth(png, info) == 16) png_set_swap(png);
    result.pixelAspect = png_get_pixel_aspect_ratio(png, info);
    double* c = result.chromaticities;
    result.hasChromaticities =
        png_get_cHRM(png, info, c, c + 1, c + 2, c + 3, c + 4, c + 5, c + 6, c + 7) != 0;
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    result.width = png_get_image_width(png, info);
    result.height = png_get_image_height(png, info);
    result.bits = png_get_bit_depth(png, info);
    result.channels = png_get_channels(png, info);
    return true;
}

bool readRows(png_structp png, png_infop info, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    png_read_end(png, info);
    return true;
}

class PngReader {
public:
    PngReader(std::span<const std::byte> bytes, const std::string& name) : name_(name) {
        source_.rest = bytes;
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, onError, onWarning);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, &source_, take);
        png_set_user_limits(png_, 0x7FFFFFFF, 0x7FFFFFFF); // ours are checked after the header
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    PngInfo info() {
        PngInfo result;
        if (!readInfo(png_, info_, result)) throwDamaged();
        return result;
    }

    /// Rows of numbers of `bits` bits each, channels interleaved.
    std::vector<std::byte> pixels(const PngInfo& info) {
        const std::size_t rowBytes =
            std::size_t(info.width) * unsigned(info.channels) * unsigned(info.bits / 8);
        std::vector<std::byte> bytes(rowBytes * info.height);
        std::vector<png_bytep> rows(info.height);
        for (std::size_t y = 0; y < rows.size(); ++y)
            rows[y] = reinterpret_cast<png_bytep>(bytes.data() + y * rowBytes);
        if (!readRows(png_, info_, rows.data())) throwDamaged();
        return bytes;
    }

private:
    [[noreturn]] void throwDamaged() const {
        throw Error(ErrorKind::InvalidContent, fmt::format("{}: is damaged: {}", name_, source_.message));
    }

    const std::string& name_;
    Source source_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

void requirePlausible(const PngInfo& info, std::size_t fileBytes, const PictureLimits& limits,
                      const std::string& name) {
    constexpr std::uint64_t kMaxRatio = 1032; // deflate: 258 bytes in two bits
    const std::uint64_t pixels = std::uint64_t(info.width) * info.height;
    requirePixels(info.width, info.height, limits.maxPixelsOf(static_cast<std::size_t>(info.channels)), name);
    if (pixels / 8 / kMaxRatio > fileBytes) // at least one bit each
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: is damaged or truncated: {} bytes cannot hold {} x {} pixels", name,
                                fileBytes, info.width, info.height));
}

// Of rows of T whose channels are interleaved.
template <class T>
Image imageFrom(const std::vector<std::byte>& bytes, const PngInfo& info) {
    const auto channels = static_cast<std::size_t>(info.channels);
    const std::string_view names = channels <= 2 ? "YA" : "RGBA";
    return imageOfPixels(info.width, info.height, names.substr(0, channels),
                         [&](std::size_t x, std::size_t y, std::size_t c) {
                             constexpr float kLargest = static_cast<float>(T(~T(0)));
                             const std::size_t i = (y * info.width + x) * channels + c;
                             T stored;
                             std::memcpy(&stored, bytes.data() + i * sizeof(T), sizeof(T));
                             return static_cast<float>(stored) / kLargest;
                         });
}

} // namespace

Picture decodePng(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
    PngReader reader(bytes, name);
    const PngInfo info = reader.info();
    requirePlausible(info, bytes.size(), limits, name);
    const std::vector<std::byte> pixels = reader.pixels(info);
    Picture picture = singlePartPicture(name, fmt::format("PNG, {} bits", info.bits), ValueScale::Display,
                                        info.bits == 16 ? imageFrom<std::uint16_t>(pixels, info)
                                                        : imageFrom<std::uint8_t>(pixels, info));
    PicturePart& part = picture.parts.front();
    if (info.pixelAspect > 0.0f) part.pixelAspect = info.pixelAspect; // 0: not given
    if (info.hasChromaticities) {
        std::array<float, 8> rgbw{};
        for (std::size_t i = 0; i < 8; ++i) rgbw[i] = static_cast<float>(info.chromaticities[(i + 2) % 8]);
        part.chromaticities = rgbw;
    }
    return picture;
}

} // namespace rt
