// Scene files from end to end: rt-import, rt-grid, rt-trace.
#include "formats/image_exr.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using testing::HasSubstr;

// A white floor, 40 wide, of y = 0; its material is called "floor".
const char* const kFloor =
    "mtllib f.mtl\nv -20 0 -20\nv 20 0 -20\nv 20 0 20\nv -20 0 20\nusemtl floor\nf 4 3 2 1\n";
// Looks straight down on a small piece of its middle.
const char* const kDown =
    R"("cameras": [{"name": "down", "kind": "orthographic", "eye": [0, 1, 0], "lookAt": [0, 0, 0],
    "up": [0, 0, -1], "height": 0.01}])";

class SceneFileCommand : public testing::Test {
protected:
    void SetUp() override {
        write("f.obj", kFloor);
        write("f.mtl", "newmtl floor\nKd 1 1 1\n");
    }
    void write(const std::string& name, const std::string& content) const {
        std::filesystem::create_directories(std::filesystem::path(folder.file(name)).parent_path());
        std::ofstream(folder.file(name), std::ios::binary) << content;
    }
    static CommandResult run(const std::string& tool, std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/" + tool);
        return test::runCommand(arguments);
    }
    static void expectSuccess(const CommandResult& result) { ASSERT_EQ(result.exitCode, 0) << result.err; }

    // s.rtatlas of a scene file that this is the content of.
    void build(const std::string& json, const std::vector<std::string>& options = {}) const {
        write("s.scene.json", json);
        std::vector<std::string> arguments{folder.file("s.scene.json"), "-q", "-o", folder.file("s.rtmesh")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        expectSuccess(run("rt-import", arguments));
        expectSuccess(run("rt-grid", {folder.file("s.rtmesh"), "-q", "-o", folder.file("s.rtatlas")}));
    }
    Image render(const std::string& name, std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {folder.file("s.rtatlas"), "-q", "-o", folder.file(name),
                                             "--size", "8x8", "--reproducible"});
        const CommandResult result = run("rt-trace", arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(folder.file(name));
    }
    static double meanOf(const Image& image, const char* channel) {
        double sum = 0.0;
        for (const float value : image.find(channel)->values) sum += double(value);
        return sum / static_cast<double>(image.pixelCount());
    }

    test::TemporaryFolder folder;
};

// The radiance of a white diffuse surface is its irradiance over pi.
TEST_F(SceneFileCommand, ASphereLightsTheFloorAsItsSolidAngleSays) {
    build(std::string(R"({"models": [{"file": "f.obj"}], "lights": [
        {"kind": "sphere", "position": [0, 4, 0], "radius": 1, "intensity": [8, 4, 2]}], )") +
          kDown + "}");
    const Image image = render("a.exr", {"--camera", "down", "--spp", "256", "--ambient", "0"});
    EXPECT_NEAR(meanOf(image, "R"), 8.0 / 16.0, 0.005); // L sin^2 of the angle that its radius is seen under
    EXPECT_NEAR(meanOf(image, "B"), 2.0 / 16.0, 0.002);
}

TEST_F(SceneFileCommand, ARectangleLightsTheFloorAsItsFormFactorSays) {
    build(std::string(R"({"models": [{"file": "f.obj"}], "lights": [
        {"kind": "rectangle", "position": [0, 2, 0], "lookAt": [0, 0, 0], "width": 4, "height": 2, "intensity": 3}], )") +
          kDown + "}");
    // From a point below a corner to a parallel rectangle of a by b at height h, four times.
    const double x = 2.0 / 2.0, y = 1.0 / 2.0;
    const double factor = 4.0 / (2.0 * M_PI) *
                          (x / std::sqrt(1.0 + x * x) * std::atan(y / std::sqrt(1.0 + x * x)) +
                           y / std::sqrt(1.0 + y * y) * std::atan(x / std::sqrt(1.0 + y * y)));
    const Image image = render("a.exr", {"--camera", "down", "--spp", "256", "--ambient", "0"});
    EXPECT_NEAR(meanOf(image, "G"), 3.0 * factor, 0.01);
}

TEST_F(SceneFileCommand, AnEnvironmentInTheFileGivesThePictureThatTheOptionGives) {
    std::filesystem::create_directory(folder.file("sky"));
    Image sky;
    sky.width = 8;
    sky.height = 4;
    for (const char* name : {"B", "G", "R"}) {
        ImageChannel channel{name, ImageChannel::Type::Float, {}, {}};
        for (int i = 0; i < 32; ++i) channel.values.push_back(static_cast<float>((i * 7 + name[0]) % 11));
        sky.channels.push_back(channel);
    }
    writeImage(folder.file("sky/sky.exr"), sky);
    const std::string model =
        R"("models": [{"file": "f.obj", "materials": [{"match": "floor", "metallic": 1, "roughness": 0.5}]}])";
    const std::vector<std::string> view = {"--eye", "0,3,6", "--look-at", "0,1,0", "--spp", "8"};
    build("{" + model +
              R"(, "environment": {"file": "sky.exr", "strength": 0.75, "turn": 30}, "background": 9})",
          {"--texture-root", folder.file("sky")});
    const Image own = render("own.exr", view);
    EXPECT_GT(meanOf(own, "R"), 0.5);
    std::vector<std::string> halved = view;
    halved.insert(halved.end(), {"--environment-strength", "0.375"});
    EXPECT_NEAR(meanOf(render("half.exr", halved), "R"), 0.5 * meanOf(own, "R"), 1e-4);
    const CommandResult explained = run("rt-trace", {folder.file("s.rtatlas"), "--explain"});
    EXPECT_THAT(explained.out, HasSubstr("environment"));

    build("{" + model + "}");
    std::vector<std::string> given = view;
    given.insert(given.end(), {"--environment", folder.file("sky/sky.exr"), "--environment-strength", "0.75",
                               "--environment-turn", "30"});
    EXPECT_EQ(own.find("R")->values, render("given.exr", given).find("R")->values);
}

TEST_F(SceneFileCommand, ItsBackgroundIsSeenUnlessAnotherIsAskedFor) {
    build(R"({"models": [{"file": "f.obj"}], "background": [0.5, 0.25, 2]})");
    const std::vector<std::string> up = {"--eye", "0,1,0", "--look-at", "0,9,0.01"};
    EXPECT_EQ(render("a.exr", up).find("B")->values[0], 2.0f);
    std::vector<std::string> other = up;
    other.insert(other.end(), {"--background", "3"});
    EXPECT_EQ(render("b.exr", other).find("B")->values[0], 3.0f);
}

TEST_F(SceneFileCommand, ACamerasPathGivesFrames) {
    build(R"({"models": [{"file": "f.obj"}], "cameras": [
        {"name": "still", "eye": [0, 5, 0], "lookAt": [0, 0, 0], "up": [0, 0, -1]},
        {"name": "fall", "up": [0, 0, -1], "path": [{"frame": 1, "eye": [0, 9, 0], "lookAt": [0, 0, 0]},
                                                    {"frame": 3, "eye": [0, 5, 0], "lookAt": [0, 0, 0]}]}]})");
    const std::string atlas = folder.file("s.rtatlas");
    const CommandResult list = run("rt-trace", {atlas, "--list-cameras"});
    EXPECT_THAT(list.out, HasSubstr("still  perspective  fov 40  eye 0,5,0  look-at 0,0,0\nfall"));
    EXPECT_THAT(list.out, HasSubstr("frames 1-3"));
    const auto frames = [&](const std::string& camera) {
        return run("rt-trace", {atlas, "-q", "-o", folder.file("f%d.exr"), "--size", "8x8", "--camera",
                                camera, "--frames", "1-3"});
    };
    expectSuccess(frames("fall"));
    for (const auto& [name, depth] : {std::pair("f1.exr", 9.0f), {"f2.exr", 7.0f}, {"f3.exr", 5.0f}})
        EXPECT_NEAR(readExr(folder.file(name)).find("Z")->values[8 * 4 + 4], depth, 1e-4f) << name;
    const CommandResult still = frames("still");
    EXPECT_EQ(still.exitCode, 2);
    EXPECT_THAT(still.err, HasSubstr("--frames: the scene has no path of a camera 'still'"));
}

TEST_F(SceneFileCommand, APanoramaOfTheSceneIsOne) {
    build(R"({"models": [{"file": "f.obj"}], "cameras": [
        {"name": "round", "kind": "panorama", "eye": [0, 2, 0], "lookAt": [0, 2, -1]}]})");
    const Image image = render("a.exr", {"--camera", "round", "--aov", "Z"});
    EXPECT_EQ(image.find("A")->values[0], 0.0f) << "the sky";
    EXPECT_NEAR(image.find("Z")->values[8 * 7 + 4], 2.0f / std::cos(3.14159265f / 16.0f), 0.01f);
}

TEST_F(SceneFileCommand, SeveralInputsBecomeOneMesh) {
    write("s.scene.json", R"({"models": [{"file": "f.obj", "instances": [{}, {"translate": [0, 1, 0]}]}]})");
    const auto trianglesOf = [&](const std::string& report) {
        return nlohmann::json::parse(test::readText(folder.file(report)))["triangles"].get<int>();
    };
    expectSuccess(run("rt-import", {test::poolTablePath(), "-q", "-o", folder.file("p.rtmesh"), "--json",
                                    folder.file("p.json")}));
    const std::string mesh = folder.file("m.rtmesh"), json = folder.file("m.json"), deps = folder.file("m.d");
    const CommandResult result =
        run("rt-import", {test::poolTablePath(), folder.file("s.scene.json"), folder.file("f.obj"), "-o",
                          mesh, "--json", json, "--depfile", deps});
    expectSuccess(result);
    EXPECT_EQ(trianglesOf("m.json"), trianglesOf("p.json") + 6);
    for (const char* name : {"poolTable.mtl", "s.scene.json", "f.obj", "f.mtl"})
        EXPECT_THAT(test::readText(deps), HasSubstr(name));
    const CommandResult again = run("rt-import", {test::poolTablePath(), folder.file("s.scene.json"),
                                                  folder.file("f.obj"), "-q", "-o", "-"});
    EXPECT_TRUE(again.out == test::readText(mesh)) << "same input, same bytes";
}

TEST_F(SceneFileCommand, ErrorsAreOneLineThatNamesThePlace) {
    write("s.scene.json", R"({"models": [{"file": "f.obj", "transform": {"scale": "big"}}]})");
    const std::size_t entries = folder.entryCount();
    const CommandResult result =
        run("rt-import", {folder.file("s.scene.json"), "-o", folder.file("x.rtmesh")});
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_EQ(result.err, "rt-import: error: " + folder.file("s.scene.json") +
                              ": /models/0/transform/scale: is not [x, y, z]\n");
    EXPECT_EQ(folder.entryCount(), entries);
    write("t.scene.json", R"({"models": [{"file": "../up.obj"}]})");
    EXPECT_EQ(run("rt-import", {folder.file("t.scene.json"), "-o", folder.file("x.rtmesh")}).exitCode, 3);
    const CommandResult root = run("rt-import", {folder.file("f.obj"), "--texture-root", folder.file("no"),
                                                 "-o", folder.file("x.rtmesh")});
    EXPECT_EQ(root.exitCode, 3);
    EXPECT_THAT(root.err, HasSubstr("--texture-root"));
    EXPECT_EQ(run("rt-import", {folder.file("s.scene.json"), "-o", folder.file("s.scene.json")}).exitCode, 2);
}

} // namespace
} // namespace rt
