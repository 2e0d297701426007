#include "common/binary_io.h"
#include "formats/image_exr.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/decoded_picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace rt::test {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

/// A scanline part of 4x2 pixels at (-3, 7) and a tiled one of 20x10 pixels.
Bytes multiPartFile(const std::string& path) {
    std::vector<Imf::Header> headers(2, Imf::Header(100, 50));
    headers[0].dataWindow() = {{-3, 7}, {0, 8}};
    headers[0].setName("left");
    headers[0].setType(Imf::SCANLINEIMAGE);
    headers[0].channels().insert("Z", Imf::Channel(Imf::FLOAT));
    headers[1].dataWindow() = {{0, 0}, {19, 9}};
    headers[1].setName("right");
    headers[1].setType(Imf::TILEDIMAGE);
    headers[1].setTileDescription(Imf::TileDescription(8, 8, Imf::ONE_LEVEL));
    headers[1].channels().insert("id", Imf::Channel(Imf::UINT));
    std::vector<float> depths(8);
    std::vector<std::uint32_t> ids(200);
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = static_cast<float>(i) / 3.0f;
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<std::uint32_t>(i * 0x01010101u);
    {
        Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
        Imf::OutputPart left(file, 0);
        Imf::FrameBuffer leftFrame;
        leftFrame.insert("Z", Imf::Slice::Make(Imf::FLOAT, depths.data(), headers[0].dataWindow()));
        left.setFrameBuffer(leftFrame);
        left.writePixels(2);
        Imf::TiledOutputPart right(file, 1);
        Imf::FrameBuffer rightFrame;
        rightFrame.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), headers[1].dataWindow()));
        right.setFrameBuffer(rightFrame);
        right.writeTiles(0, right.numXTiles() - 1, 0, right.numYTiles() - 1);
    }
    const auto bytes = readFile(path);
    return {bytes.begin(), bytes.end()};
}

TEST(PictureExr, EveryPartIsReadWithItsWindows) {
    const TemporaryFolder folder;
    const Picture picture = decode(multiPartFile(folder.file("parts.exr")));
    ASSERT_EQ(picture.parts.size(), 2u);
    EXPECT_EQ(picture.parts[0].name, "left");
    EXPECT_EQ(picture.parts[0].dataWindow, (PixelBox{-3, 7, 1, 9}));
    EXPECT_EQ(picture.parts[0].displayWindow, (PixelBox{0, 0, 100, 50}));
    EXPECT_EQ(channel(picture, "Z")[7], 7.0f / 3.0f);
    EXPECT_EQ(picture.parts[1].name, "right");
    EXPECT_EQ(picture.parts[1].image.find("id")->uints.at(199), 199u * 0x01010101u);
}

TEST(PictureExr, DamagedFilesOfSeveralPartsAreRefused) {
    const TemporaryFolder folder;
    const Bytes bytes = multiPartFile(folder.file("parts.exr"));
    expectSafe(bytes, 1);
    PictureLimits limits;
    limits.maxPixels = 199;
    EXPECT_EQ(errorOf(bytes, limits).first, ErrorKind::LimitExceeded);
    limits = {};
    limits.maxValues = 207; // the parts together have 208
    EXPECT_THAT(errorOf(bytes, limits).second, HasSubstr("208 values in 2 parts exceed 207"));
}

Bytes fileOf(const std::string& path, Imf::Compression compression, int sampling) {
    Imf::Header header(8, 4);
    header.compression() = compression;
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.channels().insert("BY", Imf::Channel(Imf::HALF, sampling, sampling));
    std::vector<Imath::half> luminance(32, Imath::half(0.5f)), chroma(32);
    for (std::size_t i = 0; i < 32; ++i) chroma[i] = Imath::half(static_cast<float>(i));
    {
        Imf::OutputFile file(path.c_str(), header, 0);
        Imf::FrameBuffer frame;
        frame.insert("Y", Imf::Slice::Make(Imf::HALF, luminance.data(), header.dataWindow()));
        frame.insert(
            "BY", Imf::Slice::Make(Imf::HALF, chroma.data(), header.dataWindow(), 0, 0, sampling, sampling));
        file.setFrameBuffer(frame);
        file.writePixels(4);
    }
    const auto bytes = readFile(path);
    return {bytes.begin(), bytes.end()};
}

TEST(PictureExr, SubsampledChannelsHoldForTheirBlocks) {
    const TemporaryFolder folder;
    const Bytes bytes = fileOf(folder.file("yc.exr"), Imf::ZIP_COMPRESSION, 2);
    const Picture picture = decode(bytes);
    const std::vector<float>& chroma = channel(picture, "BY");
    ASSERT_EQ(chroma.size(), 32u);
    for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 8; ++x)
            EXPECT_EQ(chroma[y * 8 + x], static_cast<float>(y / 2 * 4 + x / 2));
    EXPECT_THROW(decodeExr(bytes, "test"), Error) << "the environment of rt-trace wants R G B";
    expectSafe(bytes, 1);
}

TEST(PictureExr, TheCameraIsRead) {
    const TemporaryFolder folder;
    Imf::Header header(1, 1, 1.0f, Imath::V2f(0.25f, -1.0f), 2.5f);
    header.insert("worldToCamera", Imf::M44dAttribute(Imath::M44d(3.0)));
    header.insert("view", Imf::StringAttribute("left"));
    header.insert("envmap", Imf::EnvmapAttribute(Imf::ENVMAP_CUBE));
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    const float value = 1.0f;
    Imf::FrameBuffer frame;
    frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(&value)), 4, 4));
    {
        Imf::OutputFile file(folder.file("c.exr").c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(1);
    }
    const PicturePart part = readPicture(folder.file("c.exr"), {}).parts.at(0);
    EXPECT_THAT(part.camera,
                ElementsAre(testing::Pair("envmap", "cube"), testing::Pair("screenWindowCenter", "0.25 -1"),
                            testing::Pair("screenWindowWidth", "2.5"), testing::Pair("view", "left")));
    EXPECT_EQ(part.image.matrices.at("worldToCamera"), std::vector<float>(16, 3.0f));
}

TEST(PictureExr, OtherCompressionsAreReadOnlyWhenTrusted) {
    const TemporaryFolder folder;
    for (const auto compression : {Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION,
                                   Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
        const Bytes bytes = fileOf(folder.file("c.exr"), compression, 1);
        EXPECT_THAT(errorOf(bytes).second, EndsWith("NONE, RLE, ZIPS or ZIP"));
        PictureLimits limits;
        limits.allCompressionsOption = "--trust";
        EXPECT_THAT(errorOf(bytes, limits).second, EndsWith("ZIP, or trust it with --trust"));
        limits.allCompressions = true;
        EXPECT_NEAR(channel(decode(bytes, limits), "Y")[5], 0.5f, 0.01f);
    }
}

TEST(PictureExr, TheWholeCollectionIsReadOrRefused) {
    const std::string folder = scenePath("images/exr_damaged");
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no scenes";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        ++files;
        for (const bool all : {false, true}) {
            PictureLimits limits;
            limits.allCompressions = all;
            try {
                readPicture(entry.path().string(), limits);
                ADD_FAILURE() << entry.path() << " was read";
            } catch (const Error& error) {
                EXPECT_TRUE(error.kind() == ErrorKind::InvalidContent ||
                            error.kind() == ErrorKind::LimitExceeded)
                    << entry.path() << error.what();
            }
        }
    }
    EXPECT_GE(files, 80);
    for (const auto& entry : std::filesystem::directory_iterator(scenePath("images/exr"))) {
        PictureLimits limits;
        limits.allCompressions = true;
        EXPECT_NO_THROW(readPicture(entry.path().string(), limits)) << entry.path();
    }
}

} // namespace
} // namespace rt::test
