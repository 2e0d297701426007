// rt-trace with a scene's cameras, and its animations.
#include "formats/recipe.h"
#include "tests/cli/picture_command.h"

#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using test::PictureCommand;
using testing::HasSubstr;

TEST_F(PictureCommand, CamerasOfTheSceneAreListedAndTaken) {
    const CommandResult list = trace({"--list-cameras"});
    EXPECT_EQ(list.exitCode, 0) << list.err;
    EXPECT_THAT(list.out, HasSubstr("front  perspective  fov 30"));
    EXPECT_THAT(list.out, HasSubstr("plan view  orthographic  height 4"));
    const auto cameras = nlohmann::json::parse(trace({"--list-cameras", "--json", "-"}).out).at("cameras");
    ASSERT_EQ(cameras.size(), 2u);
    EXPECT_EQ(cameras[0].at("name"), "front");
    EXPECT_EQ(cameras[0].at("fovDegrees"), 30.0);
    EXPECT_EQ(cameras[1].at("projection"), "orthographic");
    EXPECT_EQ(cameras[1].at("eye"), nlohmann::json({0.0, 0.0, 8.0}));
    const Image front = render("front.exr", {"--camera", "front"});
    EXPECT_NEAR(front.find("Z")->values[32 * 64 + 32], 4.0f, 0.02f);
    const Image moved = render("moved.exr", {"--camera", "front", "--eye", "0,0,7"});
    EXPECT_NEAR(moved.find("Z")->values[32 * 64 + 32], 6.0f, 0.02f);
    const Image plan = render("plan.exr", {"--camera", "plan view"});
    EXPECT_NEAR(plan.find("Z")->values[32 * 64 + 32], 7.0f, 0.02f);
    EXPECT_EQ(plan.find("A")->values[32 * 64 + 14], 0.0f); // the sphere is half as wide as the picture
    EXPECT_EQ(plan.find("A")->values[32 * 64 + 18], 1.0f);
    expectUsage({"--camera", "back"}, "front, plan view");
}

TEST_F(PictureCommand, CamerasThatAreNotUsedAreNamed) {
    const std::string note =
        "all of the scene is framed; --camera takes one of its cameras: front, plan view\n";
    const std::vector<std::string> picture{"-o", out.file("note.exr"), "--size", "8"};
    const auto errOf = [&](std::vector<std::string> more) {
        more.insert(more.begin(), picture.begin(), picture.end());
        return trace(more).err;
    };
    EXPECT_THAT(errOf({}), HasSubstr(note));
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"-q"}, {"--camera", "front"}, {"--eye", "0,0,7"}})
        EXPECT_THAT(errOf(more), testing::Not(HasSubstr("is framed"))) << more[0];
}

TEST_F(PictureCommand, FramesFollowTheirPath) {
    std::ofstream(out.file("path.json")) << R"([{"frame": 1, "eye": [0, 0, 4], "lookAt": [0, 0, 0]},
               {"frame": 3, "eye": [0, 0, 6], "lookAt": [0, 0, 0]}])";
    const CommandResult result = trace({"-o", out.file("f%02d.exr"), "--size", "16x16", "--frames", "1-3",
                                        "--camera-path", out.file("path.json"), "--json", out.file("j")});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto frames = nlohmann::json::parse(test::readText(out.file("j"))).at("frames");
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_EQ(frames[1].at("frame"), 2);
    EXPECT_EQ(frames[1].at("camera").at("eye"), nlohmann::json({0.0, 0.0, 5.0}));
    EXPECT_GT(frames[2].at("gpuMs"), 0.0);
    for (const auto& [name, depth] : {std::pair("f01.exr", 3.0f), {"f02.exr", 4.0f}, {"f03.exr", 5.0f}})
        EXPECT_NEAR(readExr(out.file(name)).find("Z")->values[8 * 16 + 8], depth, 0.05f) << name;
    const std::string path = out.file("path.json");
    expectUsage({"--frames", "1-3"}, "--frames needs --turntable, --camera-path, or --camera");
    expectUsage({"--camera-path", path}, "go together");
    expectUsage({"--frames", "1-3", "--camera-path", path}, "%d or %04d");
    expectUsage({"--frames", "3-1", "--camera-path", path}, "--frames");
}

TEST_F(PictureCommand, ATurntableGivesEachFrameTheSamePictureWhicheverOthersAreRendered) {
    const auto turn = [&](const char* name, const char* frames) {
        return trace({"-o", out.file(name), "--size", "16x16", "--frames", frames, "--turntable", "3",
                      "--reproducible", "--json", out.file("j")});
    };
    ASSERT_EQ(turn("all%d.exr", "1-4").exitCode, 0);
    const auto frames = nlohmann::json::parse(test::readText(out.file("j"))).at("frames");
    EXPECT_NE(frames[0].at("camera").at("eye"), frames[1].at("camera").at("eye"));
    ASSERT_EQ(turn("one%d.exr", "2").exitCode, 0);
    EXPECT_EQ(contentIdOf(out.file("one2.exr")), contentIdOf(out.file("all2.exr"))) << "lights have moved";
    const Image first = readExr(out.file("all1.exr")), fourth = readExr(out.file("all4.exr"));
    for (std::size_t i = 0; i < first.find("R")->values.size(); ++i)
        EXPECT_NEAR(first.find("R")->values[i], fourth.find("R")->values[i], 1e-3f) << "a full turn later";
    expectUsage({"--turntable", "3"}, "--turntable needs --frames");
}

TEST_F(PictureCommand, NamesWithNumbersNeedFrames) {
    const CommandResult result = trace({"-o", out.file("x%d.exr"), "--size", "8"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("x%d.exr: %d stands for the number of a frame"));
    EXPECT_EQ(out.entryCount(), 0u);
}

} // namespace
} // namespace rt
