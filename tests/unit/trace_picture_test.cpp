#include "common/error.h"
#include "formats/heat_color.h"
#include "formats/image.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-trace/camera_path.h"
#include "tools/rt-trace/frame_range.h"
#include "tools/rt-trace/picture_files.h"
#include "tools/rt-trace/tone_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace rt {
namespace {

ErrorKind kindOf(const std::function<void()>& work, std::string* message = nullptr) {
    try {
        work();
    } catch (const Error& error) {
        if (message) *message = error.what();
        return error.kind();
    }
    return ErrorKind::Internal;
}

TEST(ToneMap, CurvesAreThoseOfTheirSources) {
    EXPECT_EQ(toneMapped(ToneMap::None, glm::dvec3(4, 2, 1)), glm::dvec3(4, 2, 1));
    const double luminance = 0.2126 * 4 + 0.7152 * 2 + 0.0722;
    EXPECT_NEAR(luminanceOf(toneMapped(ToneMap::Reinhard, glm::dvec3(4, 2, 1))), luminance / (1 + luminance),
                1e-12);
    EXPECT_NEAR(toneMapped(ToneMap::Aces, glm::dvec3(1))[0], 2.54 / 3.16, 1e-12);
    EXPECT_NEAR(toneMapped(ToneMap::Filmic, glm::dvec3(5.6))[0], 1.0, 1e-12); // 11.2 is white
    for (const ToneMap map : {ToneMap::Reinhard, ToneMap::Aces, ToneMap::Filmic}) {
        double last = -1e-9;
        for (double x = 0.0; x < 8.0; x += 0.01) {
            const double shown = toneMapped(map, glm::dvec3(x))[1];
            ASSERT_GE(shown, last) << int(map) << " at " << x;
            last = shown;
        }
    }
}

TEST(HeatColor, GetsLighterAllTheWay) {
    EXPECT_EQ(heatColor(0.0), glm::dvec3(68, 1, 84) / 255.0);
    EXPECT_EQ(heatColor(2.0), glm::dvec3(253, 231, 37) / 255.0);
    EXPECT_EQ(heatColor(std::nan("")), heatColor(0.0));
    double last = 0.0;
    for (double t = 0.0; t <= 1.0; t += 0.01) {
        const glm::dvec3 color = heatColor(t);
        const double lightness = luminanceOf({decodeSrgb(color.r), decodeSrgb(color.g), decodeSrgb(color.b)});
        ASSERT_GT(lightness, last) << t;
        last = lightness;
    }
}

Image onePixel(float r, float g, float b) {
    Image image;
    image.width = image.height = 1;
    for (const auto& [name, value] : {std::pair("A", 0.5f), {"B", b}, {"G", g}, {"R", r}}) {
        ImageChannel channel;
        channel.name = name;
        channel.values = {value};
        image.channels.push_back(channel);
    }
    return image;
}

TEST(PictureFiles, AScreenGetsNoAlphaAndTheExposure) {
    const Image shown = forScreen(onePixel(0.25f, 0.5f, 1.0f), ToneMap::None, 1.0);
    EXPECT_EQ(shown.find("A"), nullptr);
    EXPECT_EQ(shown.find("R")->values[0], 0.5f);
    EXPECT_EQ(shown.find("B")->values[0], 2.0f);
}

TEST(PictureFiles, HeatIsRelativeToTheMostOrToWhatWasAsked) {
    FilmPixels pixels{std::vector<glm::vec4>(2, glm::vec4(1.0f)), {}, {}};
    pixels.texcoords = {{0, 0, 5, 1}, {0, 0, 10, 4}};
    FilmPixels asked = pixels;
    EXPECT_EQ(paintHeat(pixels, Heat::Steps, 0.0), 10.0);
    EXPECT_NEAR(pixels.colors[1].r, decodeSrgb(heatColor(1.0).r), 1e-6);
    EXPECT_NEAR(pixels.colors[0].g, decodeSrgb(heatColor(0.5).g), 1e-6);
    EXPECT_EQ(pixels.colors[0].a, 1.0f);
    EXPECT_EQ(paintHeat(asked, Heat::Tests, 8.0), 8.0);
    EXPECT_NEAR(asked.colors[1].g, decodeSrgb(heatColor(0.5).g), 1e-6);
}

TEST(PictureFiles, HeatOfTimeIsThatOfTheClock) {
    FilmPixels pixels{std::vector<glm::vec4>(200, glm::vec4(1.0f)), {}, {}};
    pixels.albedos = std::vector<glm::vec4>(200, {9, 9, 9, 200});
    pixels.albedos[0].a = 50.0f;
    pixels.albedos[7].a = 1e7f; // interrupted
    pixels.texcoords = std::vector<glm::vec4>(200, glm::vec4(1e9f));
    EXPECT_EQ(paintHeat(pixels, Heat::Time, 0.0), 200.0);
    EXPECT_NEAR(pixels.colors[0].g, decodeSrgb(heatColor(0.25).g), 1e-6);
}

TEST(FramePath, NumbersGoWhereTheNameSays) {
    EXPECT_EQ(framePath("a%d.exr", 7), "a7.exr");
    EXPECT_EQ(framePath("a%04d.exr", 7), "a0007.exr");
    EXPECT_EQ(framePath("%02d/x.png", 123), "123/x.png");
    for (const char* const bad : {"a.exr", "a%s.exr", "a%d%d.exr", "a%4d.exr", "a%", "a%0", "%04"})
        EXPECT_EQ(framePath(bad, 1), std::nullopt) << bad;
}

class CameraPath : public testing::Test {
protected:
    std::vector<CameraKey> read(const std::string& text) const {
        std::ofstream(folder.file("path.json")) << text;
        return readCameraPath(folder.file("path.json"));
    }
    test::TemporaryFolder folder;
};

TEST_F(CameraPath, IsStraightBetweenItsFramesAndStillOutside) {
    const auto keys = read(R"([{"frame": 10, "eye": [0, 0, 8], "lookAt": [0, 0, 0], "up": [0, 0, 1]},
                               {"frame": 20, "eye": [4, 0, 0], "lookAt": [0, 2, 0], "fov": 60}])");
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].frame, 10.0);
    EXPECT_EQ(keys[1].up, glm::dvec3(0, 1, 0));
    CameraRequest request;
    request.lensRadius = 0.25;
    const CameraRequest middle = cameraAt(keys, 15, request);
    EXPECT_EQ(*middle.eye, glm::dvec3(2, 0, 4));
    EXPECT_EQ(*middle.lookAt, glm::dvec3(0, 1, 0));
    EXPECT_EQ(*middle.up, glm::dvec3(0, 0.5, 0.5));
    EXPECT_DOUBLE_EQ(*middle.fovDegrees, 50.0);
    EXPECT_EQ(middle.lensRadius, 0.25);
    for (const double before : {0.0, 10.0}) EXPECT_EQ(*cameraAt(keys, before, {}).eye, glm::dvec3(0, 0, 8));
    for (const double after : {20.0, 99.0}) EXPECT_EQ(*cameraAt(keys, after, {}).eye, glm::dvec3(4, 0, 0));
}

TEST_F(CameraPath, SaysWhatIsWrongWithAFile) {
    const std::vector<std::pair<const char*, const char*>> files = {
        {"", "is no JSON"},
        {"[]", "JSON array"},
        {"{}", "JSON array"},
        {"[1]", ": /0: is no object"},
        {R"([{"frame": 1, "eye": [0, 0, 0]}])", "/0: lookAt is missing"},
        {R"([{"frame": 1, "eye": [0, 0], "lookAt": [0, 0, 1]}])", "/0/eye: is not [x, y, z]"},
        {R"([{"frame": "1", "eye": [0, 0, 0], "lookAt": [0, 0, 1]}])", "/0/frame: is no number"},
        {R"([{"frame": 1, "eye": [0, 0, 0], "lookAt": [0, 0, 1], "lens": 1}])", "/0: 'lens' is none of"},
        {R"([{"frame": 1, "eye": [0, 0, 0], "lookAt": [0, 0, 1]},
             {"frame": 1, "eye": [0, 0, 0], "lookAt": [0, 0, 1]}])",
         "/1/frame: 1 does not come after 1"}};
    for (const auto& [text, message] : files) {
        std::string said;
        EXPECT_EQ(kindOf([&, t = text] { read(t); }, &said), ErrorKind::InvalidContent) << text;
        EXPECT_THAT(said, testing::HasSubstr(message));
    }
}

} // namespace
} // namespace rt
