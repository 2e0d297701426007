#include "formats/picture.h"

#include "tests/unit/decoded_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <jpeglib.h>

namespace rt::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string channelNames(const Picture& picture) {
    std::string names;
    for (const ImageChannel& found : picture.parts.front().image.channels) names += found.name;
    return names;
}

Bytes text(const std::string& value) {
    const auto* first = reinterpret_cast<const std::byte*>(value.data());
    return {first, first + value.size()};
}

/// A PNG of 5x3 pixels that hold 0, 1, 2, ... times `factor`.
Bytes pngOf(int bits, int colorType, int factor, int interlace = PNG_INTERLACE_NONE,
            bool withPalette = false) {
    Bytes bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &bytes,
        [](png_structp p, png_bytep data, std::size_t size) {
            auto& out = *static_cast<Bytes*>(png_get_io_ptr(p));
            const auto* first = reinterpret_cast<const std::byte*>(data);
            out.insert(out.end(), first, first + size);
        },
        nullptr);
    png_set_IHDR(png, info, 5, 3, bits, colorType, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (withPalette) {
        std::array<png_color, 16> palette{};
        for (std::size_t i = 0; i < 16; ++i) palette[i] = {png_byte(i), png_byte(2 * i), png_byte(255 - i)};
        png_set_PLTE(png, info, palette.data(), 16);
    }
    png_set_pHYs(png, info, 100, 200, PNG_RESOLUTION_UNKNOWN); // per unit: pixels are twice as wide as high
    png_set_cHRM(png, info, 0.31, 0.32, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06);
    png_write_info(png, info);
    const int channels = png_get_channels(png, info);
    std::vector<png_byte> pixels;
    for (int i = 0; i < 5 * 3 * channels; ++i) {
        const int value = i * factor;
        if (bits == 16) pixels.push_back(png_byte(value >> 8));
        pixels.push_back(png_byte(value));
    }
    std::vector<png_bytep> rows;
    for (int y = 0; y < 3; ++y) rows.push_back(pixels.data() + y * 5 * channels * (bits / 8));
    png_write_image(png, rows.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

TEST(PicturePng, EveryNumberIsReadAsItIsStored) {
    const Picture rgb = decode(pngOf(8, PNG_COLOR_TYPE_RGB, 5));
    EXPECT_EQ(rgb.format, "PNG, 8 bits");
    EXPECT_EQ(rgb.scale, ValueScale::Display);
    EXPECT_EQ(channelNames(rgb), "BGR");
    EXPECT_EQ(rgb.parts[0].dataWindow, (PixelBox{0, 0, 5, 3}));
    for (std::size_t i = 0; i < 15; ++i) {
        EXPECT_EQ(channel(rgb, "R")[i], static_cast<float>(15 * i) / 255.0f);
        EXPECT_EQ(channel(rgb, "B")[i], static_cast<float>(15 * i + 10) / 255.0f);
    }
    const Picture deep = decode(pngOf(16, PNG_COLOR_TYPE_RGB_ALPHA, 1021));
    EXPECT_EQ(deep.format, "PNG, 16 bits");
    EXPECT_EQ(channelNames(deep), "ABGR");
    for (std::size_t i = 0; i < 15; ++i)
        EXPECT_EQ(channel(deep, "A")[i], static_cast<float>((4 * i + 3) * 1021) / 65535.0f);
    EXPECT_EQ(channelNames(decode(pngOf(8, PNG_COLOR_TYPE_GRAY, 17))), "Y");
    EXPECT_EQ(channelNames(decode(pngOf(16, PNG_COLOR_TYPE_GRAY_ALPHA, 2000))), "AY");
    EXPECT_EQ(channel(decode(pngOf(8, PNG_COLOR_TYPE_GRAY, 17)), "Y")[14], 238.0f / 255.0f);
}

TEST(PicturePng, PalettesAndInterlacingChangeNothing) {
    const Picture colors = decode(pngOf(8, PNG_COLOR_TYPE_PALETTE, 1, PNG_INTERLACE_NONE, true));
    EXPECT_EQ(channelNames(colors), "BGR");
    EXPECT_EQ(channel(colors, "G")[7], 14.0f / 255.0f);
    EXPECT_EQ(channel(colors, "B")[7], 248.0f / 255.0f);
    EXPECT_EQ(channel(decode(pngOf(16, PNG_COLOR_TYPE_RGB, 999, PNG_INTERLACE_ADAM7)), "G"),
              channel(decode(pngOf(16, PNG_COLOR_TYPE_RGB, 999)), "G"));
}

TEST(PicturePng, MetadataIsKept) {
    const PicturePart part = decode(pngOf(8, PNG_COLOR_TYPE_RGB, 1)).parts[0];
    EXPECT_FLOAT_EQ(part.pixelAspect, 2.0f);
    ASSERT_TRUE(part.chromaticities);
    EXPECT_FLOAT_EQ((*part.chromaticities)[0], 0.64f);
    EXPECT_FLOAT_EQ((*part.chromaticities)[7], 0.32f);
}

TEST(PicturePng, DamagedFilesAreRefused) {
    expectSafe(pngOf(16, PNG_COLOR_TYPE_RGB, 777), 1);
    PictureLimits limits;
    limits.maxPixels = 14;
    EXPECT_EQ(errorOf(pngOf(8, PNG_COLOR_TYPE_RGB, 1), limits).first, ErrorKind::LimitExceeded);
}

Bytes jpegOf(int components, J_COLOR_SPACE space, bool progressive = false) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &memory, &size);
    info.image_width = 40;
    info.image_height = 24;
    info.input_components = components;
    info.in_color_space = space;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 95, TRUE);
    info.X_density = 2; // per unit: pixels are half as wide as high
    if (progressive) jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    while (info.next_scanline < info.image_height) {
        std::vector<unsigned char> row;
        for (int x = 0; x < 40 * components; ++x)
            row.push_back(
                static_cast<unsigned char>(40 + 3 * (x / components) + 4 * int(info.next_scanline)));
        JSAMPROW first = row.data();
        jpeg_write_scanlines(&info, &first, 1);
    }
    jpeg_finish_compress(&info);
    const auto* first = reinterpret_cast<const std::byte*>(memory);
    Bytes bytes(first, first + size);
    jpeg_destroy_compress(&info);
    std::free(memory);
    return bytes;
}

TEST(PictureJpeg, GreyAndColorAreRead) {
    for (const bool progressive : {false, true}) {
        const Picture color = decode(jpegOf(3, JCS_RGB, progressive));
        EXPECT_EQ(color.format, "JPEG");
        EXPECT_EQ(color.parts[0].pixelAspect, 0.5f);
        EXPECT_EQ(channelNames(color), "BGR");
        EXPECT_NEAR(channel(color, "G")[10 * 40 + 20], (40 + 60 + 40) / 255.0, 0.02);
    }
    EXPECT_EQ(channelNames(decode(jpegOf(1, JCS_GRAYSCALE))), "Y");
    EXPECT_THAT(errorOf(jpegOf(4, JCS_CMYK)).second, HasSubstr("4 components"));
}

TEST(PictureJpeg, DamagedFilesAreRefused) {
    const Bytes bytes = jpegOf(3, JCS_RGB, true);
    expectSafe(bytes, 3);
    EXPECT_EQ(errorOf(Bytes(bytes.begin(), bytes.end() - 20)).first, ErrorKind::InvalidContent)
        << "the library would fill the rest with grey";
}

TEST(PicturePfm, RowsStandBottomFirstInEitherByteOrder) {
    const float values[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    std::string little = "PF\n2 2\n-1.0\n", big = "PF 2 2 1.0\n";
    for (const float value : values) {
        char bytes[4];
        std::memcpy(bytes, &value, 4);
        little.append(bytes, 4);
        big.append({bytes[3], bytes[2], bytes[1], bytes[0]});
    }
    for (const std::string& file : {little, big}) {
        const Picture picture = decode(text(file));
        EXPECT_EQ(picture.scale, ValueScale::Linear);
        EXPECT_THAT(channel(picture, "R"), ElementsAre(7, 10, 1, 4));
        EXPECT_THAT(channel(picture, "B"), ElementsAre(9, 12, 3, 6));
        EXPECT_EQ(errorOf(text(file + "x")).first, ErrorKind::InvalidContent);
    }
    expectSafe(text(little), 1);
    EXPECT_THAT(channel(decode(text(std::string("Pf\n1 1\n-1\n\0\0\x80\x3f", 14))), "Y"), ElementsAre(1.0f));
    EXPECT_EQ(errorOf(text("PF 100000 100000 -1\n")).first, ErrorKind::LimitExceeded);
    for (const char* broken : {"PF", "PF 0 1 1\n", "PF -1 1 1\n", "PF a b c\n", "PF 1 1 0\n", "PF 1 1 nan\n"})
        EXPECT_EQ(errorOf(text(broken)).first, ErrorKind::InvalidContent) << broken;
}

TEST(PictureHdr, IsReadAsLinearLight) {
    const std::string flat = std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                             "\x80\x40\x20\x81" + "\x80\x80\x80\x80";
    const Picture picture = decode(text(flat));
    EXPECT_EQ(picture.format, "Radiance HDR");
    EXPECT_EQ(channelNames(picture), "BGR");
    EXPECT_THAT(channel(picture, "R"), ElementsAre(1.0f, 0.5f));
    EXPECT_THAT(channel(picture, "B"), ElementsAre(0.25f, 0.5f));
    PictureLimits limits;
    limits.maxPixels = 1;
    EXPECT_EQ(errorOf(text(flat), limits).first, ErrorKind::LimitExceeded);
}

TEST(Picture, AllFormatsKeepTheLimitOnValues) {
    const std::string pfm = "PF 2 1 -1.0\n" + std::string(24, '\0');
    const std::string hdr = std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                            "\x80\x40\x20\x81" + "\x80\x80\x80\x80";
    for (const Bytes& bytes : {pngOf(8, PNG_COLOR_TYPE_RGB, 1), jpegOf(3, JCS_RGB), text(pfm), text(hdr)}) {
        PictureLimits limits;
        limits.maxValues = 3 * decode(bytes).parts[0].image.pixelCount();
        EXPECT_NO_THROW(decode(bytes, limits));
        --limits.maxValues;
        EXPECT_EQ(errorOf(bytes, limits).first, ErrorKind::LimitExceeded) << decode(bytes).format;
    }
}

TEST(Picture, WhatIsNoPictureIsRefusedByItsStart) {
    EXPECT_THAT(errorOf(text("not a picture")).second, HasSubstr("is not an OpenEXR file, nor a PNG"));
    EXPECT_THAT(errorOf({}).second, HasSubstr("is not an OpenEXR file"));
    EXPECT_THROW(readPicture("/dev/zero", {}), Error);
}

} // namespace
} // namespace rt::test
