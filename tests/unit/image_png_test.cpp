#include "common/error.h"
#include "formats/image.h"
#include "formats/image_exr.h"
#include "formats/image_png.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <filesystem>
#include <limits>
#include <memory>

namespace rt {
namespace {

using Type = ImageChannel::Type;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Image colorImage(std::uint32_t width, std::uint32_t height, std::vector<float> r, std::vector<float> g,
                 std::vector<float> b) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = {{"B", Type::Float, std::move(b), {}},
                      {"G", Type::Float, std::move(g), {}},
                      {"R", Type::Half, std::move(r), {}}};
    return image;
}

struct Decoded {
    int width = 0, height = 0, channels = 0;
    std::vector<int> values;
};

Decoded decode(const std::vector<std::byte>& bytes) {
    Decoded d;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                              &d.width, &d.height, &d.channels, 0),
        stbi_image_free);
    if (pixels) d.values.assign(pixels.get(), pixels.get() + d.width * d.height * d.channels);
    return d;
}

TEST(ImagePng, ColorsAreSrgbEncodedAndRowsStartAtTheTop) {
    // Linear 0.5 is sRGB 188, 0.2140 is 127.5 -> 127 or 128, 0.0031308 * 0.5 is 5.16 -> 5 (the linear part).
    const Image image = colorImage(1, 2, {0.5f, 0.0f}, {0.0015654f, 1.0f}, {1.0f, 0.05f});
    const Decoded png = decode(encodePng(image));
    EXPECT_EQ(png.width, 1);
    EXPECT_EQ(png.height, 2);
    EXPECT_EQ(png.channels, 3);
    EXPECT_EQ(png.values, (std::vector<int>{188, 5, 255, 0, 255, 63}));
}

TEST(ImagePng, ValuesAreClampedAndNonFiniteOnesAreBlack) {
    const Image image = colorImage(2, 2, {-1.0f, 2.0f, kNan, kInf}, {0, 0, 0, 0}, {0, 0, 0, -kInf});
    EXPECT_EQ(decode(encodePng(image)).values, (std::vector<int>{0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(ImagePng, AlphaIsKeptLinear) {
    Image image = colorImage(1, 1, {0.5f}, {0.5f}, {0.5f});
    image.channels.insert(image.channels.begin(), {"A", Type::Half, {0.5f}, {}});
    const Decoded png = decode(encodePng(image));
    EXPECT_EQ(png.channels, 4);
    EXPECT_EQ(png.values, (std::vector<int>{188, 188, 188, 128}));
}

TEST(ImagePng, AMissingColorIsAUsageError) {
    Image image = colorImage(1, 1, {0.5f}, {0.5f}, {0.5f});
    image.channels.pop_back();
    try {
        encodePng(image);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Usage);
    }
}

TEST(WriteImage, ExtensionChoosesTheFormatWhateverItsCase) {
    const test::TemporaryFolder folder;
    const Image image = colorImage(1, 1, {0.5f}, {0.5f}, {0.5f});
    writeImage(folder.file("a.EXR"), image);
    writeImage(folder.file("a.png"), image);
    EXPECT_EQ(readExr(folder.file("a.EXR")).find("R")->values, std::vector<float>{0.5f});
    EXPECT_EQ(std::filesystem::file_size(folder.file("a.png")), encodePng(image).size());
    for (const char* path : {"a.jpg", "a", "exr", "dir.exr/a", "-"}) {
        EXPECT_FALSE(imageFileType(path)) << path;
        EXPECT_THROW(writeImage(path, image), Error) << path;
    }
    EXPECT_EQ(folder.entryCount(), 2u);
}

} // namespace
} // namespace rt
