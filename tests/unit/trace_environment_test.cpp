#include "common/error.h"
#include "formats/gpu_interface.shared.h"
#include "formats/image_exr.h"
#include "formats/image_hdr.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-trace/environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace rt {
namespace {

TEST(Environment, OneColourIsTheSameEverywhere) {
    const EnvironmentMap map = loadEnvironment("0.5,1,0.25");
    EXPECT_EQ(map.width, 2u);
    EXPECT_EQ(map.height, 64u);
    EXPECT_EQ(map.pixels, (std::vector<glm::vec3>(128, glm::vec3(0.5f, 1.0f, 0.25f))));
    const double luminance = 0.2126 * 0.5 + 0.7152 + 0.0722 * 0.25;
    EXPECT_NEAR(map.cdf[2], luminance * 2.0 / M_PI, 1e-3);
    EXPECT_NEAR(map.cdf[3 + 32], 0.5, 1e-6);
    EXPECT_EQ(map.cdf[environmentRow(2, 64, 17) + 1], 0.5f);
    EXPECT_EQ(loadEnvironment("3").pixels[1], glm::vec3(3.0f));
}

TEST(Environment, PartsOfTheLightFollowLuminanceAndTheRowsSize) {
    // Two rows, sin(pi / 4) each: white 1 and 3 above; nothing below.
    const std::vector<glm::vec3> pixels = {glm::vec3(1), glm::vec3(3), glm::vec3(0), glm::vec3(0)};
    const std::vector<float> cdf = environmentCdf(2, 2, pixels);
    ASSERT_EQ(cdf.size(), 3u + 3u + 2u * 3u);
    EXPECT_NEAR(cdf[2], std::sqrt(0.5), 1e-6);
    EXPECT_THAT(std::vector<float>(cdf.begin() + 3, cdf.begin() + 6), testing::ElementsAre(0, 1, 1));
    EXPECT_EQ(environmentRow(2, 2, 1), 9u);
    EXPECT_THAT(std::vector<float>(cdf.begin() + 6, cdf.begin() + 9),
                testing::ElementsAre(0, testing::FloatEq(0.25f), 1));
    EXPECT_THAT(std::vector<float>(cdf.begin() + 9, cdf.end()), testing::ElementsAre(0, 0.5f, 1))
        << "a row without light is even";
}

// The density over directions of the distribution integrates to 1, by rows of the sphere.
TEST(Environment, TheDistributionCoversTheSphereOnce) {
    constexpr unsigned kWidth = 16, kHeight = 8;
    std::vector<glm::vec3> pixels;
    for (unsigned i = 0; i < kWidth * kHeight; ++i) pixels.emplace_back(static_cast<float>(i * 37 % 11));
    const std::vector<float> cdf = environmentCdf(kWidth, kHeight, pixels);
    double sum = 0.0;
    for (unsigned row = 0; row < kHeight; ++row)
        for (unsigned x = 0; x < kWidth; ++x) {
            const std::size_t first = environmentRow(kWidth, kHeight, row) + x;
            const double part = double(cdf[3 + row + 1] - cdf[3 + row]) * double(cdf[first + 1] - cdf[first]);
            const double sine = std::sin(M_PI * (row + 0.5) / kHeight);
            const double expected = pixels[row * kWidth + x].x * sine / (double(cdf[2]) * kWidth * kHeight);
            EXPECT_NEAR(part, expected, 1e-6);
            sum += part;
        }
    EXPECT_NEAR(sum, 1.0, 1e-5);
}

TEST(Environment, BlackHasNoLightAndIsEven) {
    const EnvironmentMap map = loadEnvironment("0");
    EXPECT_EQ(map.cdf[2], 0.0f);
    EXPECT_FLOAT_EQ(map.cdf[3 + 16], 0.25f);
    EXPECT_EQ(map.cdf[environmentRow(2, 64, 17) + 1], 0.5f);
}

TEST(Environment, ExrKeepsItsRowsAndLosesWhatIsNoLight) {
    Image image;
    image.width = 2;
    image.height = 1;
    for (const char* name : {"B", "G", "R"}) {
        ImageChannel channel;
        channel.name = name;
        channel.values = {name[0] == 'R' ? -1.0f : 2.0f, name[0] == 'G' ? std::nanf("") : 3.0f};
        image.channels.push_back(channel);
    }
    const test::TemporaryFolder folder;
    writeImage(folder.file("e.exr"), image);
    const EnvironmentMap map = loadEnvironment(folder.file("e.exr"));
    EXPECT_EQ(map.pixels, (std::vector<glm::vec3>{{0, 2, 2}, {3, 0, 3}}));
}

// Two pixels as they are, without run lengths: mantissa / 256 * 2^(exponent - 128).
std::string tinyHdr() {
    return std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
           std::string("\x80\x40\x20\x81\xff\x80\x00\x84", 8);
}

TEST(Environment, RadiancePicturesAreRead) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("e.HDR"), std::ios::binary) << tinyHdr();
    const EnvironmentMap map = loadEnvironment(folder.file("e.HDR"));
    ASSERT_EQ(map.pixels.size(), 2u);
    EXPECT_EQ(map.pixels[0], glm::vec3(1.0f, 0.5f, 0.25f));
    EXPECT_EQ(map.pixels[1], glm::vec3(255.0f / 16.0f, 8.0f, 0.0f));
}

ErrorKind kindOf(const std::string& text) {
    try {
        loadEnvironment(text);
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::Internal;
}

TEST(Environment, WhatIsNoneIsRefused) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.file("e.hdr"), std::ios::binary) << tinyHdr().substr(0, 20);
    EXPECT_EQ(kindOf("sky.jpg"), ErrorKind::Usage);
    EXPECT_EQ(kindOf("1,2"), ErrorKind::Usage);
    EXPECT_EQ(kindOf("-1"), ErrorKind::Usage);
    EXPECT_EQ(kindOf(folder.file("absent.hdr")), ErrorKind::FileAccess);
    EXPECT_EQ(kindOf(folder.file("e.hdr")), ErrorKind::InvalidContent);
}

// Rows of eight equal pixels, packed: a decoder would wait for the rest of the second for ever.
TEST(Environment, RowsThatEndEarlyAreRefused) {
    const test::TemporaryFolder folder;
    std::string row("\x02\x02\x00\x08", 4);
    for (int component = 0; component < 4; ++component) row += "\x88\x80";
    const std::string whole = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n" + row + row;
    const std::string path = folder.file("e.hdr");
    std::ofstream(path, std::ios::binary) << whole;
    EXPECT_EQ(loadEnvironment(path).pixels.size(), 16u);
    for (std::size_t cut = 1; cut <= row.size(); ++cut) {
        std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - cut);
        EXPECT_EQ(kindOf(path), ErrorKind::InvalidContent) << cut;
    }
}

} // namespace
} // namespace rt
