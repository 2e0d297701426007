// rt-trace as a user runs it: exit codes, messages, and what it leaves behind.
#include "formats/atlas_file.h"
#include "formats/image_exr.h"
#include "formats/mesh_file.h"
#include "formats/recipe.h"
#include "formats/shader_binary_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>

namespace rt {
namespace {

using test::CommandResult;
using testing::HasSubstr;

void spit(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

class TraceCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<test::TemporaryFolder>();
        writeMesh(folder->file("s.rtmesh"), test::makeSphere(3));
        const CommandResult grid = test::runCommand({RT_BIN_DIR "/rt-grid", folder->file("s.rtmesh"), "-o",
                                                     folder->file("s.rtatlas"), "--structure", "cloud"});
        ASSERT_EQ(grid.exitCode, 0) << grid.err;
    }
    static void TearDownTestSuite() { folder.reset(); }

    CommandResult trace(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-trace");
        return test::runCommand(arguments);
    }
    std::string atlas() const { return folder->file("s.rtatlas"); }

    // One line on standard error, that code, and no output.
    void expectFailure(std::vector<std::string> arguments, int exitCode, const std::string& message) {
        const std::string output = out.file("out.exr");
        std::replace(arguments.begin(), arguments.end(), std::string("OUT"), output);
        const CommandResult result = trace(arguments);
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_THAT(result.err, HasSubstr("rt-trace: error: "));
        EXPECT_EQ(out.entryCount(), 0u) << "something was left behind";
    }

    static std::unique_ptr<test::TemporaryFolder> folder;
    test::TemporaryFolder out;
};
std::unique_ptr<test::TemporaryFolder> TraceCommand::folder;

TEST_F(TraceCommand, RendersEveryOutputAndTheFigures) {
    const CommandResult result = trace({atlas(), "-o", out.file("a.exr"), "-o", out.file("a.png"), "--size",
                                        "64x48", "--stats", "--json", out.file("a.json")});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("device "));
    const Image image = readExr(out.file("a.exr"));
    EXPECT_EQ(image.width, 64u);
    EXPECT_EQ(image.height, 48u);
    for (const char* name : {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "id"})
        EXPECT_TRUE(image.find(name)) << name;
    EXPECT_EQ(test::readText(out.file("a.png")).substr(1, 3), "PNG");
    const auto json = nlohmann::json::parse(test::readText(out.file("a.json")));
    for (const char* key : {"gpuMs", "loadMs", "contextMs", "planMs", "uploadMs", "compileMs", "waitMs",
                            "readbackMs", "writeMs", "mraysPerSecond", "stepsPerRay", "testsPerRay"})
        EXPECT_GE(json.at(key).get<double>(), 0.0) << key;
    EXPECT_GE(json.at("firstDispatchMs").get<double>(),
              json.at("contextMs").get<double>() + json.at("uploadMs").get<double>());
    EXPECT_GE(json.at("raysTotal").get<std::uint64_t>(), 64u * 48u);
    EXPECT_TRUE(json.at("device").is_string());
    EXPECT_EQ(json.at("atlas").at("triangles"), 1280);
    EXPECT_EQ(json.at("width"), 64);
    EXPECT_EQ(json.at("selfHits"), 0);
    EXPECT_GE(json.at("features").size(), 28u);
    for (const nlohmann::json& feature : json.at("features"))
        EXPECT_FALSE(feature.at("reason").get<std::string>().empty()) << feature;
}

TEST_F(TraceCommand, ReproduciblePicturesAreTheSameBytes) {
    for (const char* name : {"a.exr", "b.exr"})
        ASSERT_EQ(trace({atlas(), "-o", out.file(name), "--size", "32", "--reproducible", "-q", "-j",
                         name[0] == 'a' ? "1" : "2"})
                      .exitCode,
                  0);
    EXPECT_EQ(test::readText(out.file("a.exr")), test::readText(out.file("b.exr")));
}

TEST_F(TraceCommand, CameraOptionsMoveThePicture) {
    ASSERT_EQ(trace({atlas(),    "-o",           out.file("a.exr"), "--size",
                     "32x32",    "--eye",        "0,0,-3",          "--look-at",
                     "-0.5,0,0", "--up",         "0,1,0",           "--fov",
                     "60",       "--light",      "0,0,-5",          "--ambient",
                     "0",        "--background", "0.5,0.25,0.125",  "--max-depth",
                     "0"})
                  .exitCode,
              0);
    const Image image = readExr(out.file("a.exr"));
    EXPECT_EQ(image.find("G")->values[0], 0.25f);
    EXPECT_EQ(image.find("A")->values[0], 0.0f);
    EXPECT_NEAR(image.find("Z")->values[16 * 32 + 16], 2.1f, 0.05f);
    // Picture right is -x, so the sphere at x = 0 stands left of the middle.
    std::size_t left = 0, right = 0;
    for (std::size_t i = 0; i < 32 * 32; ++i)
        (i % 32 < 16 ? left : right) += image.find("id")->uints[i] != 0xFFFFFFFFu;
    EXPECT_GT(left, right + 20);
    EXPECT_GT(image.find("G")->values[16 * 32 + 16], 0.1f);
}

// 99 rays from all around, at what is near the middle.
std::string raysFromAllSides() {
    std::string bytes;
    for (int i = 0; i < 99; ++i) {
        const float angle = 0.4f * static_cast<float>(i), height = 0.02f * static_cast<float>(i) - 1.0f;
        const float ray[8] = {3.0f * std::cos(angle), 0.0f,   3.0f * std::sin(angle), 0.0f,
                              -std::cos(angle),       height, -std::sin(angle),       1e30f};
        bytes.append(reinterpret_cast<const char*>(ray), sizeof(ray));
    }
    return bytes;
}

TEST_F(TraceCommand, TheOrderOfRaysDoesNotChangeAHit) {
    spit(out.file("rays"), raysFromAllSides());
    for (const std::string order : {"auto", "coherent", "scattered"})
        ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file(order), "--ray-order", order})
                      .exitCode,
                  0);
    const std::string hits = test::readText(out.file("coherent"));
    EXPECT_EQ(hits.size(), 99u * 16u);
    EXPECT_EQ(test::readText(out.file("scattered")), hits);
    EXPECT_EQ(test::readText(out.file("auto")), hits);
}

// Mesa's software renderer ends loops after 65,535 rounds.
TEST_F(TraceCommand, WalksThatTheDeviceCutsShortAreALimitAndNoHits) {
    writeMesh(out.file("s.rtmesh"), test::makeSphere(7)); // 327,680 triangles in one voxel
    ASSERT_EQ(test::runCommand({RT_BIN_DIR "/rt-grid", out.file("s.rtmesh"), "-o", out.file("s.rtatlas"),
                                "--structure", "uniform", "--resolution", "1"})
                  .exitCode,
              0);
    spit(out.file("rays"), raysFromAllSides());
    for (const std::string order : {"coherent", "scattered"}) {
        const CommandResult result = trace({out.file("s.rtatlas"), "--rays", out.file("rays"), "-o",
                                            out.file("hits"), "--ray-order", order, "--device", "software"});
        EXPECT_EQ(result.exitCode, 5) << order;
        EXPECT_THAT(result.err, HasSubstr("more steps and triangle tests"));
        EXPECT_FALSE(std::filesystem::exists(out.file("hits")));
    }
    const CommandResult picture =
        trace({out.file("s.rtatlas"), "-o", out.file("p.exr"), "--size", "8x8", "--device", "software"});
    EXPECT_EQ(picture.exitCode, 5);
    EXPECT_FALSE(std::filesystem::exists(out.file("p.exr")));
}

TEST_F(TraceCommand, PrecisionAndTriangleTestAreReportedAndAgree) {
    spit(out.file("rays"), raysFromAllSides());
    const auto hitsOf = [&](const std::string& precision, const std::string& intersect) {
        const std::string file = out.file(precision + intersect);
        EXPECT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", file, "--precision", precision,
                         "--intersect", intersect, "--json", out.file("j")})
                      .exitCode,
                  0);
        return test::readText(file);
    };
    const std::string reference = hitsOf("double", "watertight");
    ASSERT_EQ(reference.size(), 99u * 32u);
    for (const std::string intersect : {"watertight", "moller-trumbore", "baldwin-webber"}) {
        const std::string hits = hitsOf("float", intersect);
        ASSERT_EQ(hits.size(), 99u * 16u);
        std::size_t found = 0;
        for (std::size_t i = 0; i < 99; ++i) {
            float t;
            double exact;
            std::memcpy(&t, &hits[16 * i], sizeof t);
            std::memcpy(&exact, &reference[32 * i], sizeof exact);
            EXPECT_NEAR(t, exact, 1e-3) << intersect << ", ray " << i;
            found += t > 0.0f;
        }
        EXPECT_GT(found, 20u);
    }
    const auto features = nlohmann::json::parse(test::readText(out.file("j"))).at("features");
    EXPECT_TRUE(std::any_of(features.begin(), features.end(), [](const nlohmann::json& feature) {
        return feature.at("macro") == "RT_INTERSECT" && feature.at("value") == 2;
    }));
}

TEST_F(TraceCommand, PicturesInDoublePrecisionAreNearlyTheSame) {
    for (const std::string precision : {"float", "double"})
        ASSERT_EQ(
            trace({atlas(), "-o", out.file(precision + ".exr"), "--size", "32x32", "--precision", precision})
                .exitCode,
            0);
    const Image a = readExr(out.file("float.exr")), b = readExr(out.file("double.exr"));
    for (const char* channel : {"R", "Z", "N.X"})
        for (std::size_t i = 0; i < 32 * 32; ++i)
            EXPECT_NEAR(a.find(channel)->values[i], b.find(channel)->values[i], 1e-3) << channel << i;
}

TEST_F(TraceCommand, TracesRaysAndReportsTimes) {
    const float rays[2][8] = {{0, 0, 5, 0, 0, 0, -1, 1e30f}, {0, 0, 5, 0, 0, 0, 1, 1e30f}};
    spit(out.file("rays"), std::string(reinterpret_cast<const char*>(rays), sizeof(rays)));
    ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file("hits"), "--repeat", "3", "--stats",
                     "--json", out.file("j")})
                  .exitCode,
              0);
    const std::string hits = test::readText(out.file("hits"));
    ASSERT_EQ(hits.size(), 32u);
    float t[2];
    std::uint32_t id[2];
    for (std::size_t i = 0; i < 2; ++i) {
        std::memcpy(&t[i], hits.data() + 16 * i, 4);
        std::memcpy(&id[i], hits.data() + 16 * i + 12, 4);
    }
    EXPECT_NEAR(t[0], 4.0f, 0.02f);
    EXPECT_LT(id[0], 1280u);
    EXPECT_EQ(t[1], -1.0f);
    EXPECT_EQ(id[1], 0xFFFFFFFFu);
    const auto json = nlohmann::json::parse(test::readText(out.file("j")));
    EXPECT_EQ(json.at("rays"), 2);
    EXPECT_EQ(json.at("hits"), 1);
    EXPECT_LE(json.at("minMs").get<double>(), json.at("medianMs").get<double>());
    EXPECT_GT(json.at("mraysPerSecond").get<double>(), 0.0);
    EXPECT_EQ(json.at("structure"), "cloud");
    EXPECT_EQ(json.at("anyHit"), false);
    EXPECT_EQ(json.at("hitsId"), contentIdOf(out.file("hits")).value_or(""));
    EXPECT_EQ(json.at("raysTotal"), 2);
    EXPECT_GT(json.at("firstDispatchMs").get<double>(), json.at("contextMs").get<double>());
}

TEST_F(TraceCommand, NoRaysGiveAnEmptyFile) {
    spit(out.file("rays"), "");
    ASSERT_EQ(trace({atlas(), "--rays", out.file("rays"), "-o", out.file("hits")}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(out.file("hits")));
    EXPECT_EQ(std::filesystem::file_size(out.file("hits")), 0u);
}

TEST_F(TraceCommand, WrongUsageIs2) {
    const std::string rays = folder->file("s.rtmesh"); // never read
    expectFailure({}, 2, "no scene");
    expectFailure({atlas()}, 2, "-o");
    expectFailure({atlas(), "-o", out.file("x.jpg")}, 2, ".exr or .png");
    expectFailure({atlas(), "-o", "OUT", "--size", "0x4"}, 2, "--size");
    expectFailure({atlas(), "-o", "OUT", "--size", "4x4x4"}, 2, "--size");
    expectFailure({atlas(), "-o", "OUT", "--eye", "1,2"}, 2, "--eye");
    expectFailure({atlas(), "-o", "OUT", "--eye", "1,2,nan"}, 2, "--eye");
    expectFailure({atlas(), "-o", "OUT", "--eye", "1,2,3", "--look-at", "1,2,3"}, 2, "same point");
    expectFailure({atlas(), "-o", "OUT", "--eye", "0,0,3", "--up", "0,0,1"}, 2, "--up");
    expectFailure({atlas(), "-o", "OUT", "--fov", "180"}, 2, "--fov");
    expectFailure({atlas(), "-o", "OUT", "--max-depth", "17"}, 2, "--max-depth");
    expectFailure({atlas(), "-o", "OUT", "--light", "1,2,3,4"}, 2, "--light");
    expectFailure({atlas(), "-o", "OUT", "--ambient", "-1"}, 2, "--ambient");
    expectFailure({atlas(), "-o", "OUT", "--device", "best"}, 2, "--device");
    expectFailure({atlas(), "-o", "OUT", "--any-hit"}, 2, "--any-hit");
    expectFailure({atlas(), "-o", "OUT", "--rays", rays, "--size", "4x4"}, 2, "--size");
    expectFailure({atlas(), "-o", "OUT", "-o", out.file("b"), "--rays", rays}, 2, "one -o");
    expectFailure({atlas(), "-o", "OUT", "--rays", rays, "--ray-order", "sorted"}, 2, "--ray-order");
    expectFailure({atlas(), "-o", "OUT.exr", "--ray-order", "scattered"}, 2, "--ray-order needs --rays");
    expectFailure({atlas(), "-o", "OUT.exr", "--precision", "half"}, 2, "--precision");
    expectFailure({atlas(), "-o", "OUT.exr", "--intersect", "best"}, 2, "--intersect");
    expectFailure({atlas(), "-o", "OUT", "--unknown"}, 2, "--unknown");
    expectFailure({atlas(), "-o", "OUT", "-o", "OUT"}, 2, "two outputs");
    expectFailure({atlas(), "-o", "OUT", "--json", "OUT"}, 2, "two outputs");
    expectFailure({atlas(), "-o", "-", "--rays", rays, "--json", "-"}, 2, "two outputs");
    expectFailure({atlas(), "-o", rays, "--rays", rays}, 2, "an input and an output");
    expectFailure({atlas(), "-o", "OUT", "--json", atlas()}, 2, "an input and an output");
    expectFailure({atlas(), "-o", ""}, 2, "empty");
}

TEST_F(TraceCommand, FilesThatCannotBeReadOrWrittenAre3) {
    expectFailure({out.file("none.rtatlas"), "-o", "OUT"}, 3, "none.rtatlas");
    expectFailure({atlas(), "-o", out.file("no/folder/a.exr"), "--size", "8"}, 3, "a.exr");
    expectFailure({atlas(), "-o", "OUT", "--rays", out.file("none.f32")}, 3, "none.f32");
}

TEST_F(TraceCommand, InvalidContentIs4) {
    const std::string whole = test::readText(atlas());
    const std::string bad = folder->file("bad.rtatlas");
    for (const std::size_t size : {std::size_t(0), std::size_t(63), whole.size() / 2, whole.size() - 1}) {
        spit(bad, whole.substr(0, size));
        expectFailure({bad, "-o", "OUT"}, 4, "bad.rtatlas");
    }
    expectFailure({folder->file("s.rtmesh"), "-o", "OUT"}, 4, "s.rtmesh");
    spit(folder->file("odd.f32"), std::string(33, '\0'));
    expectFailure({atlas(), "-o", "OUT", "--rays", folder->file("odd.f32")}, 4, "33 bytes");
}

TEST_F(TraceCommand, InputWithoutAnEndIsRefused) {
    expectFailure({"/dev/zero", "-o", "OUT"}, 4, "/dev/zero: is not a .rtatlas file");
#ifndef __SANITIZE_ADDRESS__ // which reserves more addresses than that
    const CommandResult rays = test::runCommand({"/bin/sh", "-c",
                                                 "ulimit -v 2000000 && exec " RT_BIN_DIR "/rt-trace " +
                                                     atlas() + " --rays /dev/zero -o " + out.file("hits")});
    EXPECT_EQ(rays.exitCode, 5) << rays.err;
    EXPECT_THAT(rays.err, HasSubstr("/dev/zero: "));
    EXPECT_FALSE(std::filesystem::exists(out.file("hits")));
#endif
}

TEST_F(TraceCommand, PicturesLargerThanTheDeviceAllowsAre5) {
    expectFailure({atlas(), "-o", "OUT", "--size", "100000x4"}, 5, "--size 100000x4");
}

TEST_F(TraceCommand, AnOutputThatCannotBeWrittenLeavesNoOtherOneBehind) {
    expectFailure({atlas(), "-o", "OUT", "-o", out.file("no/folder/a.png"), "--size", "8"}, 3, "a.png");
    expectFailure({atlas(), "-o", "OUT", "--json", out.file("no/folder/a.json"), "--size", "8"}, 3, "a.json");
}

// Runs of one picture with a cache of shaders of their own.
class ShaderCacheCommand : public TraceCommand {
protected:
    // What the report says of the cache; the picture is to be the same each time.
    bool fromCache(std::vector<std::string> options = {}, const std::string& environment = "UNUSED=1") {
        std::vector<std::string> command = {"/usr/bin/env",
                                            "XDG_CACHE_HOME=" + out.file("cache"),
                                            "RT_NO_SHADER_CACHE=",
                                            environment,
                                            RT_BIN_DIR "/rt-trace",
                                            atlas(),
                                            "-o",
                                            out.file("a.exr"),
                                            "--size",
                                            "16",
                                            "--reproducible",
                                            "--json",
                                            out.file("j")};
        command.insert(command.end(), options.begin(), options.end());
        const CommandResult result = test::runCommand(command);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        const std::string picture = contentIdOf(out.file("a.exr")).value_or("");
        EXPECT_EQ(picture, first.empty() ? picture : first);
        first = picture;
        return nlohmann::json::parse(test::readText(out.file("j"))).at("shaderFromCache");
    }
    std::vector<std::string> files() const {
        std::vector<std::string> paths;
        std::error_code absent;
        for (const auto& entry : std::filesystem::directory_iterator(out.file("cache/rt-tools"), absent))
            paths.push_back(entry.path().string());
        return paths;
    }
    std::string first;
};

TEST_F(ShaderCacheCommand, ShadersAreCompiledOnceAndDrawTheSame) {
    EXPECT_FALSE(fromCache({"--no-shader-cache"}));
    EXPECT_FALSE(fromCache({}, "RT_NO_SHADER_CACHE=1"));
    EXPECT_EQ(files().size(), 0u);
    EXPECT_FALSE(fromCache());
    if (files().empty()) GTEST_SKIP() << "the driver gives no binaries out";
    EXPECT_TRUE(fromCache());
    EXPECT_FALSE(fromCache({"--no-shader-cache"}));
    EXPECT_EQ(files().size(), 2u);       // walks and shading
    EXPECT_TRUE(fromCache({"--stats"})); // those that count are kept too
    EXPECT_EQ(files().size(), 4u);
}

TEST_F(ShaderCacheCommand, DamagedAndForeignFilesAreReplaced) {
    EXPECT_FALSE(fromCache());
    if (files().empty()) GTEST_SKIP() << "the driver gives no binaries out";
    const std::string path = files().at(0);
    const std::string whole = test::readText(path);
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
    ShaderBinary foreign = readShaderBinary(path);
    foreign.bytes = std::vector<std::byte>(foreign.bytes.size()); // whole, but no driver's
    writeShaderBinary(out.file("foreign"), foreign);
    ShaderBinary another = readShaderBinary(path);
    another.key ^= 1;
    writeShaderBinary(out.file("another"), another);
    for (const std::string& bytes :
         {std::string(), whole.substr(0, whole.size() / 2), flipped, test::readText(out.file("foreign")),
          test::readText(out.file("another"))}) {
        spit(path, bytes);
        EXPECT_FALSE(fromCache());
        EXPECT_EQ(test::readText(path), whole);
        EXPECT_TRUE(fromCache());
    }
    std::filesystem::remove(path);
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0) << "reading it would never end";
    EXPECT_FALSE(fromCache());
}

TEST_F(ShaderCacheCommand, WithoutAFolderNothingIsKept) {
    spit(out.file("cache"), "no folder");
    EXPECT_FALSE(fromCache({}, "HOME=" + out.file("cache")));
    EXPECT_FALSE(fromCache({}, "HOME="));
    EXPECT_FALSE(fromCache({}, "HOME=" + out.file("home")));
    const bool kept = fromCache({}, "HOME=" + out.file("home"));
    EXPECT_EQ(kept, std::filesystem::exists(out.file("home/.cache/rt-tools"))) << "the second choice";
}

TEST_F(TraceCommand, DevicesThatDoNotExistAre6) {
    expectFailure({atlas(), "-o", "OUT", "--device", "999"}, 6, "--device 999");
}

TEST_F(TraceCommand, ListsDevicesWithTheirIndex) {
    const CommandResult result = trace({"--list-devices"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.out.substr(0, 3), "0  ");
    EXPECT_THAT(result.out, HasSubstr("ware  "));
}

TEST_F(TraceCommand, ListsMayBeJson) {
    const auto json = nlohmann::json::parse(trace({"--list-devices", "--json", "-"}).out);
    ASSERT_FALSE(json.at("devices").empty());
    const nlohmann::json& device = json.at("devices")[0];
    EXPECT_EQ(device.at("index"), 0);
    if (device.contains("problem")) return;
    EXPECT_TRUE(device.at("renderer").is_string());
    const bool told = device.at("memoryBytes").is_number();
    EXPECT_TRUE(told || device.at("memoryBytes").is_null());
    const std::string text = trace({"--list-devices", "--json", out.file("j")}).out;
    EXPECT_THAT(text, HasSubstr(device.at("software") ? "memory of this machine" : told ? " MiB" : "memory"));
    EXPECT_EQ(nlohmann::json::parse(test::readText(out.file("j"))).at("devices").size(),
              json.at("devices").size());
}

TEST_F(TraceCommand, WhatDoesNotFitIntoTheDevicesMemoryIsForetold) {
    const std::string size = "--size", most = "--max-gpu-memory";
    expectFailure({atlas(), "-o", "OUT", size, "2048", most, "144M"}, 5, "the picture 144 MiB");
    expectFailure({atlas(), "-o", "OUT", size, "2048", most, "100M"}, 5,
                  "the limit is 100 MiB (--max-gpu-memory); lower --size");
    expectFailure({atlas(), "-o", "OUT", size, "16", most, "10K"}, 5, "lower rt-grid's --resolution");
    expectFailure({atlas(), "-o", "OUT", size, "16", most, "much"}, 2, "--max-gpu-memory");
    spit(folder->file("rays"), std::string(100000 * 32, '\0'));
    expectFailure({atlas(), "-o", "OUT", "--rays", folder->file("rays"), most, "4M"}, 5,
                  "rays and hits 5 MiB");
    ASSERT_EQ(
        trace({atlas(), "-o", out.file("a.exr"), size, "16", most, "10M", "--json", out.file("j")}).exitCode,
        0);
    const auto bytes = nlohmann::json::parse(test::readText(out.file("j"))).at("gpuMemoryBytes");
    EXPECT_GT(bytes, 16 * 16 * 36);
    EXPECT_LT(bytes, 10 << 20);
}

TEST_F(TraceCommand, DevicesThatCannotBePrintedAre3) {
    const CommandResult result =
        test::runCommand({"/bin/sh", "-c", RT_BIN_DIR "/rt-trace --list-devices > /dev/full"});
    EXPECT_EQ(result.exitCode, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr("standard output"));
}

TEST_F(TraceCommand, HelpShowsTheDefaults) {
    const std::string help = trace({"--help"}).out;
    for (const char* text :
         {"512x512", "else 0.1, or none", "the scene's, or 0.32,0.4,0.5", "a radiance of 0.9", "required"})
        EXPECT_THAT(help, HasSubstr(text));
    EXPECT_THAT(help, testing::Not(HasSubstr("TEXT")));
}

} // namespace
} // namespace rt
