// rt-trace's pictures as a user makes them: parts, samples, channels, checkpoints, frames.
#include "formats/checkpoint_file.h"
#include "formats/image_exr.h"
#include "formats/mesh_file.h"
#include "formats/recipe.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using testing::HasSubstr;

NamedCamera cameraNamed(const std::string& name, std::uint32_t kind, double z) {
    NamedCamera camera{};
    name.copy(camera.name, sizeof camera.name - 1);
    camera.eye[2] = z;
    camera.up[1] = 1.0;
    camera.fovDegrees = kind == kCameraPerspective ? 30.0 : 0.0;
    camera.height = kind == kCameraOrthographic ? 4.0 : 0.0;
    camera.kind = kind;
    return camera;
}

class PictureCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<test::TemporaryFolder>();
        Mesh mesh = test::makeSphere(3);
        mesh.materials = std::vector<Material>(2, mesh.materials[0]);
        std::vector<std::uint32_t> triangleMaterial(mesh.triangles.size());
        for (std::uint32_t i = 0; i < triangleMaterial.size(); ++i) triangleMaterial[i] = i % 2;
        mesh.triangleMaterial = std::move(triangleMaterial);
        mesh.cameras = std::vector<NamedCamera>{cameraNamed("front", kCameraPerspective, 5.0),
                                                cameraNamed("plan view", kCameraOrthographic, 8.0)};
        writeMesh(folder->file("s.rtmesh"), mesh);
        const CommandResult grid = test::runCommand(
            {RT_BIN_DIR "/rt-grid", folder->file("s.rtmesh"), "-o", folder->file("s.rtatlas")});
        ASSERT_EQ(grid.exitCode, 0) << grid.err;
    }
    static void TearDownTestSuite() { folder.reset(); }

    CommandResult trace(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {RT_BIN_DIR "/rt-trace", folder->file("s.rtatlas")});
        return test::runCommand(arguments);
    }
    // Renders 64x64 pixels to an EXR, which comes back.
    Image render(const std::string& name, std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"-o", out.file(name), "--size", "64x64", "--reproducible"});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return readExr(out.file(name));
    }
    nlohmann::json figures(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"-o", out.file("j.exr"), "--json", out.file("j.json")});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return nlohmann::json::parse(test::readText(out.file("j.json")));
    }
    void expectUsage(std::vector<std::string> arguments, const std::string& message) const {
        arguments.insert(arguments.begin(), {"-o", out.file("usage.exr")});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_FALSE(std::filesystem::exists(out.file("usage.exr")));
    }
    std::string bytesOf(const std::string& name) const { return test::readText(out.file(name)); }

    static std::unique_ptr<test::TemporaryFolder> folder;
    test::TemporaryFolder out;
};
std::unique_ptr<test::TemporaryFolder> PictureCommand::folder;

TEST_F(PictureCommand, ACropKnowsTheWholePicture) {
    const Image whole = render("whole.exr", {"--spp", "3"});
    const Image part =
        render("part.exr", {"--spp", "3", "--crop", "20,10,45,50", "-o", out.file("part.png")});
    EXPECT_EQ(part.width, 25u);
    EXPECT_EQ(part.height, 40u);
    EXPECT_EQ(part.frame, (ImageFrame{20, 10, 64, 64}));
    EXPECT_FALSE(whole.frame);
    EXPECT_EQ(part.matrices.at("worldToNDC"), whole.matrices.at("worldToNDC"));
    for (const char* name : {"R", "A", "Z", "N.X"})
        for (std::size_t y = 0; y < 40; ++y)
            for (std::size_t x = 0; x < 25; ++x)
                ASSERT_EQ(part.find(name)->values[y * 25 + x],
                          whole.find(name)->values[(y + 10) * 64 + x + 20])
                    << name << " at " << x << "," << y;
    const std::string png = bytesOf("part.png");
    EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x19\0\0\0\x28", 8)); // IHDR: width, height
}

TEST_F(PictureCommand, ChannelsAreThoseThatWereAskedFor) {
    const auto namesOf = [](const Image& image) {
        std::vector<std::string> names;
        for (const ImageChannel& channel : image.channels) names.push_back(channel.name);
        return names;
    };
    EXPECT_THAT(namesOf(render("none.exr", {"--aov", "none"})), testing::ElementsAre("A", "B", "G", "R"));
    EXPECT_THAT(namesOf(render("some.exr", {"--aov", "uv,P"})),
                testing::ElementsAre("A", "B", "G", "P.X", "P.Y", "P.Z", "R", "uv.U", "uv.V"));
    const Image all = render("all.exr", {"--aov", "all", "--spp", "4"});
    EXPECT_EQ(all.channels.size(), 4u + 1 + 3 + 3 + 3 + 1 + 1 + 2 + 1 + 1 + 1);
    const std::size_t middle = 32 * 64 + 32;
    EXPECT_NEAR(all.find("albedo.R")->values[middle], all.find("albedo.G")->values[middle], 1e-6);
    EXPECT_GT(all.find("steps")->values[middle], 0.0f);
    EXPECT_GT(all.find("variance")->values[middle], 0.0f);
    const float x = all.find("P.X")->values[middle], y = all.find("P.Y")->values[middle],
                z = all.find("P.Z")->values[middle];
    EXPECT_NEAR(std::sqrt(x * x + y * y + z * z), 1.0f, 0.02f) << "on the unit sphere";
    EXPECT_EQ(all.ints.at("samplesPerPixel"), 4);
    EXPECT_FALSE(render("one.exr", {"--aov", "all"}).find("variance")) << "one sample has no variance";
}

TEST_F(PictureCommand, MaterialsAreThoseOfTheTrianglesThatWereHit) {
    const Image image = render("m.exr", {"--aov", "id,material"});
    const ImageChannel& ids = *image.find("id");
    const ImageChannel& materials = *image.find("material");
    EXPECT_EQ(materials.type, ImageChannel::Type::Uint);
    std::size_t none = 0;
    for (std::size_t i = 0; i < ids.uints.size(); ++i) {
        none += ids.uints[i] == 0xFFFFFFFFu;
        ASSERT_EQ(materials.uints[i], ids.uints[i] == 0xFFFFFFFFu ? 0xFFFFFFFFu : ids.uints[i] % 2) << i;
    }
    EXPECT_GT(none, 0u);
    EXPECT_LT(none, ids.uints.size());
}

TEST_F(PictureCommand, KernelsGiveTheSamePicture) {
    const std::vector<std::string> common = {"--size", "20x13", "--aov", "all", "--reproducible"};
    nlohmann::json reports[2];
    for (const std::string kernel : {"compute", "multipass"}) {
        std::vector<std::string> arguments = common;
        arguments.insert(arguments.end(), {"--kernel", kernel, "--stats", "-o", out.file(kernel + ".exr")});
        reports[kernel == "multipass"] = figures(arguments);
    }
    const CommandResult compared =
        test::runCommand({RT_BIN_DIR "/rt-compare", out.file("compute.exr"), out.file("multipass.exr")});
    EXPECT_EQ(compared.exitCode, 0) << compared.out << compared.err;
    EXPECT_EQ(reports[0]["kernel"], "compute");
    EXPECT_EQ(reports[1]["kernel"], "multipass");
    EXPECT_FALSE(reports[0].contains("passes"));
    EXPECT_GT(reports[1]["passes"]["traverse"], 0);
    EXPECT_EQ(reports[1]["passes"]["traverse"], reports[1]["passes"]["intersect"]);
    EXPECT_EQ(reports[0]["raysTotal"], reports[1]["raysTotal"]);
    EXPECT_EQ(reports[0]["stepsPerRay"], reports[1]["stepsPerRay"]);
    EXPECT_TRUE(reports[1]["deviceStages"].contains("intersectMs"));
}

TEST_F(PictureCommand, MultipassRefusesWhatItCannotDo) {
    expectUsage({"--kernel", "multipass", "--precision", "double"}, "--precision double does not go with");
    expectUsage({"--kernel", "multipass", "--heat", "time"}, "--kernel multipass does not go with");
    expectUsage({"--kernel", "multipass", "--aov", "time"}, "--kernel multipass does not go with");
    expectUsage({"--kernel", "multipass", "--rays", out.file("r.f32")}, "--kernel does not go with --rays");
    expectUsage({"--kernel", "cuda"}, "--kernel");
}

// Medians: a pixel may be in the middle of its work when the system runs something else.
TEST_F(PictureCommand, TimesArePixelsOwnAndNoPartOfAll) {
    const CommandResult probe = trace({"-o", out.file("t.exr"), "--size", "8", "--heat", "time"});
    if (probe.exitCode == 6) GTEST_SKIP() << probe.err;
    const Image image = render("t.exr", {"--aov", "time,id", "--spp", "4"});
    std::vector<float> hits, misses;
    for (std::size_t i = 0; i < image.pixelCount(); ++i)
        (image.find("id")->uints[i] == 0xFFFFFFFFu ? misses : hits).push_back(image.find("time")->values[i]);
    const auto medianOf = [](std::vector<float>& values) {
        std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
        return values[values.size() / 2];
    };
    EXPECT_GT(medianOf(misses), 0.0f);
    EXPECT_GT(medianOf(hits), medianOf(misses));
    EXPECT_GT(figures({"--size", "16", "--heat", "time"}).at("heatMost"), 0.0);
    EXPECT_FALSE(render("all.exr", {"--aov", "all"}).find("time"));
}

TEST_F(PictureCommand, SeedsChangeTheNoiseAndNothingElseDoes) {
    const std::vector<std::string> options = {"--spp", "2", "--filter", "gaussian", "--seed", "7"};
    render("a.exr", options);
    render("b.exr", options);
    EXPECT_EQ(bytesOf("a.exr"), bytesOf("b.exr"));
    const Image other = render("c.exr", {"--spp", "2", "--filter", "gaussian", "--seed", "8"});
    EXPECT_NE(other.find("R")->values, readExr(out.file("a.exr")).find("R")->values);
    EXPECT_EQ(other.ints.at("rt:seed"), 8);
}

TEST_F(PictureCommand, ResumedPicturesAreTheSameToTheBit) {
    const std::vector<std::string> aovs = {"--aov", "all", "--spp"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), aovs.begin(), aovs.end());
        return more;
    };
    render("whole.exr", with({"6"}));
    render("half.exr", with({"2", "--checkpoint", out.file("c")}));
    render("resumed.exr", with({"6", "--resume", out.file("c"), "--checkpoint", out.file("c")}));
    EXPECT_EQ(bytesOf("resumed.exr"), bytesOf("whole.exr"));
    render("again.exr", with({"6", "--resume", out.file("c")}));
    EXPECT_EQ(bytesOf("again.exr"), bytesOf("whole.exr")) << "there was nothing left to do";
    for (const char* const fewer : {"4", "1"})
        expectUsage({"--size", "64", "--aov", "none", "--spp", fewer, "--resume", out.file("c")},
                    "say --spp 6 or more");
}

TEST_F(PictureCommand, CheckpointsOfOtherPicturesAndDamagedOnesAreRefused) {
    render("a.exr", {"--spp", "2", "--checkpoint", out.file("c")});
    const auto expectRefusal = [&](std::vector<std::string> arguments, const std::string& message) {
        arguments.insert(arguments.begin(), {"-o", out.file("b.exr"), "--resume", out.file("c")});
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, 4) << result.err;
        EXPECT_THAT(result.err, HasSubstr(out.file("c") + ": "));
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_FALSE(std::filesystem::exists(out.file("b.exr")));
    };
    expectRefusal({"--spp", "4", "--size", "64x32"}, "its size is 64x64");
    expectRefusal({"--spp", "4", "--size", "64", "--crop", "0,0,9,9"}, "its part is 0,0,64,64");
    expectRefusal({"--spp", "4", "--size", "64", "--seed", "3"}, "its seed is 0");
    const auto expectDifferent = [&](std::vector<std::string> arguments, const std::string& names) {
        arguments.insert(arguments.begin(), {"--spp", "4", "--size", "64"});
        expectRefusal(arguments, "these settings differ from what is asked for now: " + names + "\n");
    };
    expectDifferent({"--fov", "50", "--light", "1,2,3"}, "camera, lights");
    expectDifferent({"--environment", "0.5", "--light", "1,2,3", "--ambient", "0.1"}, "lights, environment");
    expectDifferent({"--ambient", "0.2"}, "ambient light");
    expectDifferent({"--background", "0"}, "background");
    expectDifferent({"--filter", "tent"}, "filter");
    expectDifferent({"--precision", "double"}, "--precision or --intersect");
    expectDifferent({"--aov", "P"}, "channels");
    expectDifferent({"--target-error", "0.5"}, "--target-error, channels");
    std::string bytes = bytesOf("c");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    std::ofstream(out.file("c"), std::ios::binary) << bytes;
    expectRefusal({"--spp", "4", "--size", "64"}, "");
    std::ofstream(out.file("c"), std::ios::binary) << bytes.substr(0, 100);
    expectRefusal({"--spp", "4", "--size", "64"}, "");
}

TEST_F(PictureCommand, AnInterruptedRunLeavesItsCheckpointAndNoPicture) {
    const auto interrupted = [&](const std::string& seconds, const std::vector<std::string>& more) {
        std::vector<std::string> endless = {"/usr/bin/timeout",
                                            "--preserve-status",
                                            "-s",
                                            "INT",
                                            seconds,
                                            RT_BIN_DIR "/rt-trace",
                                            folder->file("s.rtatlas"),
                                            "--spp",
                                            "16000000",
                                            "-o",
                                            out.file("a.exr"),
                                            "--size",
                                            "64x64"};
        endless.insert(endless.end(), more.begin(), more.end());
        return test::runCommand(endless).exitCode;
    };
    EXPECT_EQ(interrupted("1.5", {}), 130);
    EXPECT_EQ(out.entryCount(), 0u);
    for (const std::string seconds : {"1.5", "5", "20"}) { // busy machines may compile for a while
        EXPECT_EQ(interrupted(seconds, {"--checkpoint", out.file("c")}), 130);
        if (std::filesystem::exists(out.file("c"))) break;
    }
    EXPECT_FALSE(std::filesystem::exists(out.file("a.exr")));
    ASSERT_TRUE(std::filesystem::exists(out.file("c")));
    std::uint32_t most = 0;
    for (const CheckpointTile& tile : readCheckpoint(out.file("c")).tiles)
        most = std::max(most, tile.samples);
    const Image image = render("b.exr", {"--spp", std::to_string(most + 1), "--resume", out.file("c")});
    EXPECT_EQ(image.ints.at("samplesPerPixel"), static_cast<int>(most) + 1);
}

TEST_F(PictureCommand, TimeAndErrorEndAPicture) {
    auto samples = figures({"--size", "64", "--time-limit", "0.2", "--spp", "10000000"}).at("samples");
    EXPECT_EQ(samples.at("timeLimitReached"), true);
    EXPECT_GE(samples.at("least"), 1);
    EXPECT_LT(samples.at("most"), 10000000);
    samples = figures({"--size", "96", "--target-error", "0.5"}).at("samples");
    EXPECT_EQ(samples.at("wanted"), 4096);
    EXPECT_EQ(samples.at("tiles"), 9);
    EXPECT_EQ(samples.at("tilesStoppedByError"), 9);
    EXPECT_LT(samples.at("mean").get<double>(), 200.0);
}

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

TEST_F(PictureCommand, ExplainsWhatIsCompiledAndUploaded) {
    const CommandResult result = trace({"--explain", "-q"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    for (const char* text : {"RT_LIGHT_COUNT", "RT_MAX_DEPTH", "voxels", "uploaded", "skipped"})
        EXPECT_THAT(result.out, HasSubstr(text));
    EXPECT_EQ(out.entryCount(), 0u);
    const auto json = nlohmann::json::parse(trace({"--explain", "--json", "-"}).out);
    EXPECT_EQ(json.at("sections")[0].at("name"), "voxels");
    EXPECT_FALSE(json.at("features").empty());
    const auto sections = figures({"--size", "8"}).at("sections");
    EXPECT_EQ(sections[0].at("name"), "voxels");
    EXPECT_EQ(sections[0].at("uploaded"), true);
}

TEST_F(PictureCommand, ToneMapsAndExposureAreForPngOnly) {
    const auto bytesWith = [&](const std::string& name, std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"-o", out.file(name + ".png")});
        render(name + ".exr", arguments);
        return bytesOf(name + ".png");
    };
    const std::string plain = bytesWith("plain", {});
    for (const std::string map : {"reinhard", "aces", "filmic"}) {
        EXPECT_NE(bytesWith(map, {"--tonemap", map}), plain) << map;
        EXPECT_EQ(contentIdOf(out.file(map + ".exr")), contentIdOf(out.file("plain.exr"))) << map;
    }
    EXPECT_NE(bytesWith("bright", {"--exposure", "1"}), plain);
    EXPECT_EQ(contentIdOf(out.file("bright.exr")), contentIdOf(out.file("plain.exr")));
}

TEST_F(PictureCommand, HeatShowsWhatPixelsCost) {
    const Image cold = render("cold.exr", {"--heat", "steps", "--heat-max", "1e9"});
    EXPECT_NEAR(cold.find("B")->values[32 * 64 + 32], 0.0887f, 1e-3f) << "dark violet";
    const Image hot = render("hot.exr", {"--heat", "steps", "--heat-max", "1e-3"});
    EXPECT_NEAR(hot.find("R")->values[32 * 64 + 32], 0.9823f, 1e-3f) << "yellow";
    EXPECT_GT(figures({"--size", "64", "--heat", "tests"}).at("heatMost"), 0.0);
    expectUsage({"--heat-max", "3"}, "--heat-max needs --heat");
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

TEST_F(PictureCommand, LightsWithASizeAreSeen) {
    for (const std::string light : {"sphere:0,0,3,0.5", "rectangle:0,0,3,0,0,9,1,1"}) {
        const Image image =
            render("l.exr", {"--light", light + ",2,3,4", "--eye", "0,0,6", "--look-at", "0,0,0"});
        const std::size_t middle = 32 * 64 + 32;
        EXPECT_EQ(image.find("R")->values[middle], 2.0f) << light;
        EXPECT_EQ(image.find("B")->values[middle], 4.0f) << light;
        EXPECT_EQ(image.find("id")->uints[middle], 0xFFFFFFFFu) << "a light is no triangle";
    }
    expectUsage({"--light", "sphere:0,0,3"}, "a sphere light has 4 numbers, or 7 with R,G,B, not 3");
}

TEST_F(PictureCommand, NamesWithNumbersNeedFrames) {
    const CommandResult result = trace({"-o", out.file("x%d.exr"), "--size", "8"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("x%d.exr: %d stands for the number of a frame"));
    EXPECT_EQ(out.entryCount(), 0u);
}

TEST_F(PictureCommand, ASmallPartOfAHugePictureIsNoLargerThanThePart) {
    const CommandResult result =
        trace({"-o", out.file("part.exr"), "--size", "100000x100000", "--crop", "50000,50000,50020,50010"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const Image part = readExr(out.file("part.exr"));
    EXPECT_EQ(part.width, 20u);
    EXPECT_EQ(part.frame, (ImageFrame{50000, 50000, 100000, 100000}));
    for (const std::uint32_t id : part.find("id")->uints) EXPECT_EQ(id, part.find("id")->uints[0]);
    expectUsage({"--size", "1048577x4"}, "more than 1048576 on a side");
}

TEST_F(PictureCommand, PixelsThatAreNotFiniteAreCounted) {
    const auto count = [&](std::vector<std::string> arguments) -> std::uint64_t {
        arguments.insert(arguments.begin(), {"--size", "16", "--spp", "4"});
        return figures(arguments).at("nonFinitePixels");
    };
    EXPECT_EQ(count({}), 0u);
    EXPECT_EQ(count({"--light", "0,0,9,1e30,1,1"}), 0u);
    EXPECT_GT(count({"--background", "3e38"}), 50u) << "four samples are too much for a float";
    expectUsage({"--background", "4e38"}, "--background: colours are 3.4e38 at most");
    const CommandResult result =
        trace({"-o", out.file("a.exr"), "--size", "16", "--spp", "4", "--background", "3e38"});
    EXPECT_THAT(result.err, HasSubstr("pixels have channels that are no finite numbers"));
}

TEST_F(PictureCommand, RepeatedPicturesAreTheSameAndTimed) {
    render("once.exr", {"--spp", "2"});
    render("thrice.exr", {"--spp", "2", "--repeat", "3"});
    EXPECT_EQ(contentIdOf(out.file("once.exr")), contentIdOf(out.file("thrice.exr")));
    const auto json = figures({"--size", "32", "--repeat", "3"});
    EXPECT_EQ(json.at("repeat"), 3);
    EXPECT_GT(json.at("minMs").get<double>(), 0.0);
    EXPECT_LE(json.at("minMs").get<double>(), json.at("gpuMs").get<double>());
    EXPECT_EQ(json.at("samples").at("total"), 32 * 32);
    expectUsage({"--repeat", "2", "--time-limit", "1"}, "--repeat does not go with --time-limit");
    expectUsage({"--repeat", "2", "--checkpoint", out.file("c")}, "--repeat does not go with");
    EXPECT_EQ(trace({"--list-cameras", "--repeat", "2"}).exitCode, 2);
}

// Each would do nothing.
TEST_F(PictureCommand, OptionsWithoutAnEffectAreUsage) {
    expectUsage({"--focus", "3"}, "--focus needs --lens-radius");
    expectUsage({"--camera", "front", "--focus", "3"}, "--focus needs --lens-radius");
    expectUsage({"--height", "3"}, "--height needs --projection orthographic");
    expectUsage({"--camera", "front", "--height", "3"}, "--height needs");
    expectUsage({"--projection", "panorama", "--fov", "30"}, "--fov");
    expectUsage({"--camera", "plan view", "--fov", "30"}, "--fov");
    expectUsage({"--environment-strength", "2"}, "--environment-strength needs --environment");
    expectUsage({"--environment-turn", "2"}, "--environment-turn needs --environment");
    expectUsage({"--environment", "1", "--background", "0"}, "--background needs");
    expectUsage({"--environment", "1", "--occlusion", "1"}, "--occlusion needs");
    expectUsage({"--exposure", "1"}, "--exposure needs a .png");
    expectUsage({"--tonemap", "aces"}, "--tonemap needs a .png");
    expectUsage({"-o", out.file("h.png"), "--heat", "steps", "--tonemap", "aces"}, "--tonemap needs");
    expectUsage({"--filter", "gaussian"}, "--filter needs more samples");
    EXPECT_EQ(trace({"-o", out.file("one.exr"), "--size", "8", "--spp", "1", "--filter", "tent"}).exitCode,
              0);
    expectUsage({"--filter-radius", "2"}, "--filter-radius needs more samples");
    expectUsage({"--list-devices"}, "--output does not go with --list-devices");
    expectUsage({"--list-cameras"}, "--output does not go with --list-cameras");
    const CommandResult result = trace({"-o", out.file("a.png"), "--aov", "P"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("--aov needs an .exr"));
    EXPECT_EQ(trace({"--list-cameras", "--size", "9"}).exitCode, 2);
    EXPECT_EQ(
        trace({"-o", out.file("lens.exr"), "--size", "8", "--lens-radius", "0.1", "--focus", "3"}).exitCode,
        0);
}

TEST_F(PictureCommand, WrongNumbersAreUsage) {
    expectUsage({"--spp", "0"}, "--spp");
    expectUsage({"--seed", "-1"}, "--seed");
    expectUsage({"--crop", "0,0,0,5"}, "--crop");
    expectUsage({"--crop", "0,0,513,5"}, "--crop");
    expectUsage({"--crop", "0,0,1.5,5"}, "--crop");
    expectUsage({"--filter", "lanczos"}, "--filter");
    expectUsage({"--aov", "Z,depth"}, "'depth' is none of");
    expectUsage({"--aov", "variance"}, "--spp");
    expectUsage({"--lens-radius", "-1"}, "--lens-radius");
    expectUsage({"--lens-radius", "1", "--projection", "panorama"}, "--lens-radius");
    expectUsage({"--projection", "orthographic", "--height", "0"}, "--height");
    expectUsage({"--environment", "sky.jpg"}, "--environment");
    expectUsage({"--environment", "1,2"}, "--environment");
    expectUsage({"--exposure", "nan"}, "nan");
    expectUsage({"--target-error", "0"}, "--target-error");
    expectUsage({"--resume", out.file("usage.exr")}, "");
}

} // namespace
} // namespace rt
