// rt-trace as a user runs it: exit codes, messages, and what it leaves behind.
#include "formats/image_exr.h"
#include "tests/cli/trace_command.h"

namespace rt::test {
namespace {

using testing::HasSubstr;

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
    EXPECT_EQ(readText(out.file("a.png")).substr(1, 3), "PNG");
    const auto json = nlohmann::json::parse(readText(out.file("a.json")));
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
    EXPECT_EQ(readText(out.file("a.exr")), readText(out.file("b.exr")));
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
    const std::string whole = readText(atlas());
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
    const CommandResult rays = runCommand({"/bin/sh", "-c",
                                           "ulimit -v 2000000 && exec " RT_BIN_DIR "/rt-trace " + atlas() +
                                               " --rays /dev/zero -o " + out.file("hits")});
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
    EXPECT_EQ(nlohmann::json::parse(readText(out.file("j"))).at("devices").size(), json.at("devices").size());
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
    const auto bytes = nlohmann::json::parse(readText(out.file("j"))).at("gpuMemoryBytes");
    EXPECT_GT(bytes, 16 * 16 * 36);
    EXPECT_LT(bytes, 10 << 20);
}

TEST_F(TraceCommand, DevicesThatCannotBePrintedAre3) {
    const CommandResult result =
        runCommand({"/bin/sh", "-c", RT_BIN_DIR "/rt-trace --list-devices > /dev/full"});
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
} // namespace rt::test
