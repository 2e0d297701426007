#include "common/binary_io.h"
#include "common/error.h"
#include "formats/image_exr.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPreviewImage.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <limits>

namespace rt {
namespace {

using Type = ImageChannel::Type;
using testing::HasSubstr;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// 3x2 pixels: one channel of each type, all kinds of attributes.
Image sampleImage() {
    Image image;
    image.width = 3;
    image.height = 2;
    image.channels = {{"R", Type::Half, {0.5f, 1.0f, -2.0f, 0.0f, 1024.0f, 65504.0f}, {}},
                      {"Z", Type::Float, {0.1f, kInf, -kInf, 1e30f, 1e-40f, kNan}, {}},
                      {"id", Type::Uint, {}, {0u, 1u, 0xFFFFFFFFu, 0x80000001u, 16777217u, 5u}}};
    image.texts["software"] = "rt-tools";
    image.texts["rt:empty"] = "";
    image.floats["rt:gpuMs"] = 0.25f;
    image.ints["samplesPerPixel"] = -7;
    image.matrices["worldToCamera"] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    return image;
}

Image decode(const std::vector<std::byte>& bytes) {
    return decodeExr(bytes, "test.exr");
}

/// The kind and message of the error that decoding ends with; fails the test if it succeeds.
std::pair<ErrorKind, std::string> errorOf(const std::vector<std::byte>& bytes) {
    try {
        decode(bytes);
    } catch (const Error& error) {
        return {error.kind(), error.what()};
    }
    ADD_FAILURE() << "decoding succeeded";
    return {};
}

/// Position of the value of a header attribute.
std::size_t attributeValue(const std::vector<std::byte>& bytes, const std::string& name,
                           const std::string& type) {
    const std::string key = name + '\0' + type + '\0';
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t at = text.find(key);
    EXPECT_NE(at, std::string_view::npos);
    return at + key.size() + 4;
}

template <class T>
void poke(std::vector<std::byte>& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

TEST(ImageExr, RoundTripKeepsEveryBitOfEveryChannel) {
    const Image image = sampleImage();
    const Image read = decode(encodeExr(image));
    EXPECT_EQ(read.width, 3u);
    EXPECT_EQ(read.height, 2u);
    ASSERT_EQ(read.channels.size(), 3u);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(read.channels[c].name, image.channels[c].name);
        EXPECT_EQ(read.channels[c].type, image.channels[c].type);
        EXPECT_EQ(read.channels[c].uints, image.channels[c].uints);
        ASSERT_EQ(read.channels[c].values.size(), image.channels[c].values.size());
        for (std::size_t i = 0; i < image.channels[c].values.size(); ++i)
            EXPECT_EQ(std::bit_cast<std::uint32_t>(read.channels[c].values[i]),
                      std::bit_cast<std::uint32_t>(image.channels[c].values[i]));
    }
}

TEST(ImageExr, RoundTripKeepsAttributes) {
    const Image image = sampleImage();
    const Image read = decode(encodeExr(image));
    EXPECT_EQ(read.texts, image.texts);
    EXPECT_EQ(read.floats, image.floats);
    EXPECT_EQ(read.ints, image.ints);
    EXPECT_EQ(read.matrices, image.matrices);
}

TEST(ImageExr, SameImageSameBytes) {
    EXPECT_EQ(encodeExr(sampleImage()), encodeExr(sampleImage()));
}

TEST(ImageExr, FiniteValuesBeyondTheRangeOfHalfStayFinite) {
    Image image = sampleImage();
    image.channels[0].values = {1e6f, -1e6f, kInf, 65535.0f, 1.0f, 0.0f};
    const Image read = decode(encodeExr(image));
    EXPECT_EQ(read.channels[0].values, (std::vector<float>{65504.0f, -65504.0f, kInf, 65504.0f, 1.0f, 0.0f}));
}

TEST(ImageExr, RowsAreStoredFromTheTop) {
    const std::vector<std::byte> bytes = encodeExr(sampleImage());
    EXPECT_EQ(bytes[attributeValue(bytes, "lineOrder", "lineOrder")], std::byte{0});     // increasing y
    EXPECT_EQ(bytes[attributeValue(bytes, "compression", "compression")], std::byte{3}); // ZIP
}

TEST(ImageExr, AnyTruncationIsInvalidContent) {
    const std::vector<std::byte> bytes = encodeExr(sampleImage());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_EQ(errorOf(cut).first, ErrorKind::InvalidContent)
            << size << " of " << bytes.size() << " bytes";
    }
}

TEST(ImageExr, AnyChangedByteIsReadOrRefusedButNeverWorse) {
    const std::vector<std::byte> bytes = encodeExr(sampleImage());
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        for (const unsigned mask : {0x01u, 0x80u, 0xFFu}) {
            std::vector<std::byte> changed = bytes;
            changed[at] ^= std::byte(mask);
            try {
                decode(changed);
            } catch (const Error& error) {
                EXPECT_NE(error.kind(), ErrorKind::Internal);
                EXPECT_THAT(error.what(), HasSubstr("test.exr: "));
            }
        }
    }
}

TEST(ImageExr, CompressionsWithKnownHolesAreRefusedBeforeDecoding) {
    std::vector<std::byte> bytes = encodeExr(sampleImage());
    for (const unsigned compression : {4u, 5u, 6u, 7u, 8u, 9u}) { // PIZ, PXR24, B44, B44A, DWAA, DWAB
        bytes[attributeValue(bytes, "compression", "compression")] = std::byte(compression);
        const auto [kind, message] = errorOf(bytes);
        EXPECT_EQ(kind, ErrorKind::InvalidContent);
        EXPECT_THAT(message, HasSubstr("save it with NONE, RLE, ZIPS or ZIP"));
    }
}

TEST(ImageExr, MultiPartAndDeepFilesAreRefusedByName) {
    std::vector<std::byte> bytes = encodeExr(sampleImage());
    bytes[5] = std::byte{0x10};
    EXPECT_THAT(errorOf(bytes).second, HasSubstr("several parts"));
    bytes[5] = std::byte{0x08};
    EXPECT_THAT(errorOf(bytes).second, HasSubstr("deep"));
}

TEST(ImageExr, ChannelsOutOfOrderAndNamedTwiceAreRefused) {
    Image image;
    image.width = image.height = 1;
    image.channels = {{"a", Type::Float, {1.0f}, {}}, {"b", Type::Float, {2.0f}, {}}};
    const auto renamed = [&](char first, char second) {
        std::vector<std::byte> bytes = encodeExr(image);
        const std::size_t list = attributeValue(bytes, "channels", "chlist"),
                          entry = 2 + 16; // name, 0; type to sampling
        bytes[list] = std::byte(first);
        bytes[list + entry] = std::byte(second);
        return bytes;
    };
    EXPECT_EQ(decode(renamed('c', 'd')).channels[1].values[0], 2.0f);
    EXPECT_THAT(errorOf(renamed('b', 'b')).second, HasSubstr("two channels b"));
    EXPECT_THAT(errorOf(renamed('z', 'b')).second, HasSubstr("channel z stands before b"));
}

TEST(ImageExr, HugeWindowsAreALimitAndImplausibleOnesAreDamage) {
    std::vector<std::byte> bytes = encodeExr(sampleImage());
    const std::size_t window = attributeValue(bytes, "dataWindow", "box2i");
    poke<std::int32_t>(bytes, window + 8, 16383);
    poke<std::int32_t>(bytes, window + 12, 16384); // 2^28 pixels and one row
    EXPECT_EQ(errorOf(bytes).first, ErrorKind::LimitExceeded);
    poke<std::int32_t>(bytes, window + 12, 16383);
    const auto [kind, message] = errorOf(bytes);
    EXPECT_EQ(kind, ErrorKind::InvalidContent);
    EXPECT_THAT(message, HasSubstr("cannot hold 16384 x 16384 pixels"));
    poke<std::int32_t>(bytes, window + 8, -1);
    EXPECT_THAT(errorOf(bytes).second, HasSubstr("data window is empty"));
    poke<std::int32_t>(bytes, window + 8, std::numeric_limits<std::int32_t>::max());
    poke<std::int32_t>(bytes, window, std::numeric_limits<std::int32_t>::min());
    EXPECT_EQ(errorOf(bytes).first, ErrorKind::InvalidContent);
}

TEST(ImageExr, NegativeDataWindowIsReadAsTheImage) {
    std::vector<std::byte> bytes = encodeExr(sampleImage());
    const std::size_t window = attributeValue(bytes, "dataWindow", "box2i");
    poke<std::int32_t>(bytes, window, -10);
    poke<std::int32_t>(bytes, window + 8, -8);
    EXPECT_EQ(decode(bytes).find("id")->uints, sampleImage().find("id")->uints);
}

// A 20x10 picture in mip-mapped 8x8 tiles as another program may write it, with a preview in its header.
std::vector<std::byte> tiledFile(const std::string& path, Imf::Compression compression) {
    Imf::Header header(20, 10);
    header.compression() = compression;
    header.setTileDescription(Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
    header.setPreviewImage(Imf::PreviewImage(5, 4));
    header.channels().insert("G", Imf::Channel(Imf::FLOAT));
    std::vector<float> values(200);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) / 7.0f;
    {
        Imf::TiledOutputFile file(path.c_str(), header, 0);
        Imf::FrameBuffer frame;
        frame.insert("G", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow()));
        file.setFrameBuffer(frame);
        for (int level = 0; level < file.numLevels(); ++level)
            file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
    const auto bytes = readFile(path);
    return {bytes.begin(), bytes.end()};
}

TEST(ImageExr, ReadsTheFullSizeOfTiledFilesInEachCompression) {
    const test::TemporaryFolder folder;
    for (const auto compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION}) {
        const Image image = decode(tiledFile(folder.file("tiled.exr"), compression));
        EXPECT_EQ(image.width, 20u);
        EXPECT_EQ(image.height, 10u);
        for (std::size_t i = 0; i < 200; ++i)
            EXPECT_EQ(image.find("G")->values.at(i), static_cast<float>(i) / 7.0f);
    }
}

TEST(ImageExr, DamagedTiledFilesAreReadOrRefused) {
    const test::TemporaryFolder folder;
    const std::vector<std::byte> bytes = tiledFile(folder.file("tiled.exr"), Imf::ZIP_COMPRESSION);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::vector<std::byte> changed = bytes;
        changed[at] ^= std::byte{0xFF};
        try {
            decode(changed);
        } catch (const Error& error) {
            EXPECT_NE(error.kind(), ErrorKind::Internal);
        }
    }
    std::vector<std::byte> hugeTiles = bytes;
    poke<std::uint32_t>(hugeTiles, attributeValue(bytes, "tiles", "tiledesc"), 0x7FFFFFFFu);
    EXPECT_EQ(errorOf(hugeTiles).first, ErrorKind::LimitExceeded);
    poke<std::uint32_t>(hugeTiles, attributeValue(bytes, "tiles", "tiledesc"), 0u);
    EXPECT_EQ(errorOf(hugeTiles).first, ErrorKind::InvalidContent);
}

TEST(ImageExr, EveryDamagedFileOfTheCollectionIsRefused) {
    const std::string folder = test::scenePath("images/exr_damaged");
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no scenes";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        ++files;
        try {
            readExr(entry.path().string());
            ADD_FAILURE() << entry.path() << " was read";
        } catch (const Error& error) {
            EXPECT_NE(error.kind(), ErrorKind::Internal) << entry.path();
            EXPECT_NE(error.kind(), ErrorKind::FileAccess) << entry.path();
        }
    }
    EXPECT_GE(files, 80);
}

TEST(ImageExr, AStreamWithoutAnEndIsRefusedByItsStart) {
    EXPECT_THROW(readExr("/dev/zero"), Error);
}

TEST(ImageExr, APartKnowsItsPlaceInTheWholePicture) {
    Image image = sampleImage();
    EXPECT_FALSE(decode(encodeExr(image)).frame);
    for (const ImageFrame& frame :
         {ImageFrame{5, 7, 100, 50}, ImageFrame{0, 0, 4, 2}, ImageFrame{-2, -1, 9, 9}}) {
        image.frame = frame;
        const Image read = decode(encodeExr(image));
        EXPECT_EQ(read.frame, frame);
        EXPECT_EQ(read.width, 3u);
        EXPECT_EQ(read.find("id")->uints, image.find("id")->uints);
    }
    image.frame = ImageFrame{0, 0, 3, 2};
    EXPECT_FALSE(decode(encodeExr(image)).frame) << "it is the whole picture";
}

TEST(ImageExr, MissingFileIsAFileAccessError) {
    const test::TemporaryFolder folder;
    try {
        readExr(folder.file("absent.exr"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::FileAccess);
    }
}

} // namespace
} // namespace rt
