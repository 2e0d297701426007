// Pictures in shards as a user makes them: rendered apart, merged, and what merging refuses.
#include "formats/image_exr.h"
#include "formats/mesh_file.h"
#include "formats/recipe.h"
#include "tests/support/make_mesh.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

Arguments operator+(Arguments a, const Arguments& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

class ShardCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<test::TemporaryFolder>();
        writeMesh(folder->file("s.rtmesh"), test::makeSphere(3));
        writeMesh(folder->file("t.rtmesh"), test::makeSphere(2));
        for (const std::string name : {"s", "t"}) {
            const CommandResult grid =
                test::runCommand({RT_BIN_DIR "/rt-grid", folder->file(name + ".rtmesh"), "-o",
                                  folder->file(name + ".rtatlas")});
            ASSERT_EQ(grid.exitCode, 0) << grid.err;
        }
    }
    static void TearDownTestSuite() { folder.reset(); }

    // Compiled shaders are kept for the suite.
    CommandResult run(const Arguments& arguments, const Arguments& environment = {}) const {
        return test::runCommand(
            Arguments{"/usr/bin/env", "-u", "RT_NO_SHADER_CACHE", "XDG_CACHE_HOME=" + folder->file("cache")} +
            environment + Arguments{RT_BIN_DIR "/rt-trace"} + arguments);
    }
    CommandResult trace(const Arguments& arguments) const {
        return run(Arguments{folder->file("s.rtatlas"), "-q"} + arguments);
    }
    void render(const std::string& name, const Arguments& arguments) const {
        const CommandResult result = trace(Arguments{"-o", out.file(name), "--reproducible"} + arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    /// Renders all shards to p1.exr and so on; returns their paths, the last first: their order means
    /// nothing.
    Arguments renderShards(unsigned count, const Arguments& arguments) const {
        Arguments paths;
        for (unsigned i = count; i >= 1; --i) {
            const std::string name = fmt::format("p{}.exr", i);
            render(name, arguments + Arguments{"--shard", fmt::format("{}/{}", i, count)});
            paths.push_back(out.file(name));
        }
        return paths;
    }
    void merge(const Arguments& shards, const Arguments& arguments) const {
        const CommandResult result = run(Arguments{"merge", "-q"} + shards + arguments);
        ASSERT_EQ(result.exitCode, 0) << result.err;
    }
    std::string bytesOf(const std::string& name) const { return test::readText(out.file(name)); }
    void spit(const std::string& name, const std::string& bytes) const {
        std::ofstream(out.file(name), std::ios::binary) << bytes;
    }
    void expectMergedAlike(unsigned count, const Arguments& arguments) const {
        render("whole.exr", arguments);
        merge(renderShards(count, arguments), {"-o", out.file("merged.exr")});
        EXPECT_TRUE(bytesOf("merged.exr") == bytesOf("whole.exr")) << testing::PrintToString(arguments);
    }
    void expectRefusal(const Arguments& shards, const std::string& message) const {
        const CommandResult result = run(Arguments{"merge", "-o", out.file("no.exr")} + shards);
        EXPECT_EQ(result.exitCode, 4) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_FALSE(std::filesystem::exists(out.file("no.exr")));
    }
    void expectUsage(const Arguments& arguments, const std::string& message) const {
        const CommandResult result = trace(Arguments{"-o", out.file("usage.exr")} + arguments);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_FALSE(std::filesystem::exists(out.file("usage.exr")));
    }

    static std::unique_ptr<test::TemporaryFolder> folder;
    test::TemporaryFolder out;
};
std::unique_ptr<test::TemporaryFolder> ShardCommand::folder;

TEST_F(ShardCommand, PartsMakeThePictureToTheBit) {
    const Arguments picture = {"--size", "70x150", "--spp", "3", "--aov", "all", "--seed", "7"};
    render("whole.exr", picture);
    render("bright.exr",
           picture + Arguments{"-o", out.file("whole.png"), "--tonemap", "aces", "--exposure", "1"});
    for (const unsigned count : {1u, 2u, 5u}) {
        merge(renderShards(count, picture), {"-o", out.file("merged.exr"), "-o", out.file("merged.png"),
                                             "--tonemap", "aces", "--exposure", "1"});
        EXPECT_TRUE(bytesOf("merged.exr") == bytesOf("whole.exr")) << count;
        EXPECT_EQ(contentIdOf(out.file("merged.png")), contentIdOf(out.file("whole.png"))) << count;
    }
    const Image part = readExr(out.file("p3.exr"));
    EXPECT_EQ(part.frame, (ImageFrame{0, 64, 70, 150}));
    EXPECT_EQ(part.height, 32u);
    EXPECT_EQ(part.texts.at("rt:shard"), "3/5");
    EXPECT_FALSE(readExr(out.file("merged.exr")).texts.contains("rt:shardHash"));
}

// The error is one of tiles, whose borders are those of the whole picture.
TEST_F(ShardCommand, PartsOfPartsAndWhatIsDecidedByTileAreTheSameToo) {
    expectMergedAlike(4, {"--size", "70x150", "--crop", "5,20,61,140"});
    expectMergedAlike(3,
                      {"--size", "70x150", "--crop", "0,33,70,150", "--spp", "64", "--target-error", "0.05"});
    expectMergedAlike(2, {"--size", "70x64", "--heat", "steps", "--heat-max", "40"});
    const Image merged = readExr(out.file("merged.exr"));
    EXPECT_EQ(merged.height, 64u);
}

// Sums of floats in another order: (N + n) / 2^24 of a mean at most, of the variance 8 (N + 8) / 2^24 of what
// it is the difference of, N and n being the samples of all shards and of the largest.
TEST_F(ShardCommand, SamplesMakeThePictureWithinRounding) {
    const unsigned samples = 11;
    const Arguments picture = {"--size", "48x40", "--spp", std::to_string(samples), "--aov", "all"};
    render("whole.exr", picture);
    const Image whole = readExr(out.file("whole.exr"));
    const ImageChannel& variance = *whole.find("variance");
    const ImageChannel& green = *whole.find("G");
    EXPECT_GT(*std::max_element(variance.values.begin(), variance.values.end()), 1e-4f);
    for (const unsigned count : {3u, samples, 1u}) {
        merge(renderShards(count, picture + Arguments{"--shard-by", "samples"}),
              {"-o", out.file("merged.exr")});
        const Image merged = readExr(out.file("merged.exr"));
        EXPECT_EQ(merged.ints.at("samplesPerPixel"), 11);
        std::map<std::string, std::string> texts = merged.texts, expected = whole.texts;
        for (auto* each : {&texts, &expected}) each->erase(kRecipeKey);
        EXPECT_EQ(texts, expected);
        ASSERT_EQ(merged.channels.size(), whole.channels.size());
        for (std::size_t c = 0; c < whole.channels.size(); ++c) {
            const ImageChannel &a = whole.channels[c], &b = merged.channels[c];
            ASSERT_EQ(a.name, b.name);
            EXPECT_EQ(a.uints, b.uints) << a.name;
            const bool first = a.name == "Z" || a.name[0] == 'N' || a.name[0] == 'P' || a.name[0] == 'u';
            for (std::size_t i = 0; i < a.values.size(); ++i) {
                double bound = first ? 0.0 : std::ldexp(2.0 * samples + 3.0, -24) * double(a.values[i]);
                if (a.name == "variance") {
                    const double spread = a.values[i] * (samples - 1.0), mean = 1.1 * double(green.values[i]);
                    bound = std::ldexp(8.0 * (samples + 8.0), -24) * (spread + mean * mean) / (samples - 1.0);
                }
                ASSERT_LE(std::abs(double(a.values[i]) - double(b.values[i])), bound)
                    << a.name << " at " << i << " of " << count;
            }
        }
    }
    EXPECT_EQ(contentIdOf(out.file("merged.exr")), contentIdOf(out.file("whole.exr"))) << "one shard is all";
}

TEST_F(ShardCommand, MergingIsSkippedAsLongAsShardsAndOptionsAreTheSame) {
    const Arguments picture = {"--size", "40x70"};
    const Arguments shards = renderShards(2, picture);
    const auto mergeIfChanged = [&](const Arguments& more) {
        const CommandResult result = run(Arguments{"merge", "-o", out.file("m.exr"), "-o", out.file("m.png"),
                                                   "--json", out.file("m.json"), "--if-changed"} +
                                         more + shards);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.err.find("up to date") != std::string::npos;
    };
    EXPECT_FALSE(mergeIfChanged({}));
    EXPECT_TRUE(mergeIfChanged({}));
    EXPECT_FALSE(mergeIfChanged({"--exposure", "1"}));
    renderShards(2, picture + Arguments{"--seed", "1", "--spp", "2"});
    EXPECT_FALSE(mergeIfChanged({"--exposure", "1"}));
    // The merged picture is the whole one, to --if-changed too.
    render("m.exr", picture + Arguments{"--seed", "1", "--spp", "2"});
    EXPECT_TRUE(mergeIfChanged({"--exposure", "1"}));
}

TEST_F(ShardCommand, FramesAreCutEachForItself) {
    spit("path.json", R"([{"frame": 1, "eye": [0, 0, 4], "lookAt": [0, 0, 0]},
                          {"frame": 2, "eye": [0, 1, 6], "lookAt": [0, 0, 0]}])");
    const Arguments frames = {"--size", "40x64", "--frames", "1-2", "--camera-path", out.file("path.json")};
    render("f%d.exr", frames);
    render("a%d.exr", frames + Arguments{"--shard", "1/2"});
    render("b%d.exr", frames + Arguments{"--shard", "2/2"});
    for (const int frame : {1, 2}) {
        merge({out.file(fmt::format("a{}.exr", frame)), out.file(fmt::format("b{}.exr", frame))},
              {"-o", out.file("m.exr")});
        EXPECT_TRUE(bytesOf("m.exr") == bytesOf(fmt::format("f{}.exr", frame))) << frame;
    }
    expectRefusal({out.file("a1.exr"), out.file("b2.exr")},
                  "b2.exr: is a shard of another picture than " + out.file("a1.exr") +
                      ": these differ: matrices of the camera, camera\n");
}

TEST_F(ShardCommand, MissingAndDoubledShardsAreNamed) {
    const Arguments shards = renderShards(5, {"--size", "16x150"}); // the fifth to the first
    expectRefusal({shards[0], shards[3]}, "of the 5 shards of its picture these are missing: 1, 3-4\n");
    expectRefusal({shards[4]}, shards[4] + ": of the 5 shards of its picture these are missing: 2-5\n");
    std::filesystem::copy_file(shards[1], out.file("copy.exr"));
    expectRefusal(shards + Arguments{out.file("copy.exr")},
                  "copy.exr: is shard 4/5, as is " + shards[1] + "; name each shard once");
}

TEST_F(ShardCommand, ForeignShardsAreNamedWithWhatDiffers) {
    const Arguments size = {"--size", "16x96"}, second = {"--shard", "2/3"};
    const Arguments shards = renderShards(3, size);
    const auto expectForeign = [&](const Arguments& arguments, const std::string& names) {
        render("foreign.exr", arguments);
        expectRefusal({out.file("foreign.exr"), shards[0], shards[2]},
                      out.file("foreign.exr") + ": is a shard of another picture than " + shards[0] +
                          ": these differ: " + names + "\n");
    };
    expectForeign(size + second + Arguments{"--seed", "3"}, "--seed");
    expectForeign(size + second + Arguments{"--spp", "2"},
                  "--spp, one sample per pixel, in its middle, or several, and the number of the first");
    expectForeign(size + second + Arguments{"--aov", "Z,N"}, "--aov");
    expectForeign(size + second + Arguments{"--light", "1,2,3", "--background", "0"}, "lights, background");
    expectForeign(size + second + Arguments{"--precision", "double"}, "--precision or --intersect");
    expectForeign(size + second + Arguments{"--heat", "steps", "--heat-max", "3"}, "channels, --heat");
    expectForeign(size + second + Arguments{"--crop", "0,0,15,96"}, "--crop");
    expectForeign({"--size", "16x96", "--shard", "2/2"}, "number of shards");
    expectForeign({"--size", "16x96", "--shard", "1/1", "--shard-by", "samples"},
                  "number of shards, --shard-by");
    const CommandResult other = run({folder->file("t.rtatlas"), "-o", out.file("foreign.exr"), "--size",
                                     "16x96", "--shard", "2/3", "--reproducible"});
    ASSERT_EQ(other.exitCode, 0) << other.err;
    expectRefusal({shards[0], out.file("foreign.exr"), shards[2]}, "these differ: atlas");
}

TEST_F(ShardCommand, DamagedShardsAndOtherFilesAreNamed) {
    const Arguments shards = renderShards(2, {"--size", "24x64"});
    const std::string good = bytesOf("p2.exr");
    const auto expectBad = [&](const std::string& bytes, const std::string& message) {
        spit("bad.exr", bytes);
        expectRefusal({out.file("bad.exr"), shards[1]}, message);
    };
    expectBad(good.substr(0, good.size() - 1), "bad.exr: is damaged");
    expectBad(good.substr(0, 100), "bad.exr: ");
    expectBad("", "bad.exr: is not an OpenEXR file");
    for (const std::size_t at :
         {good.find("rt:shardHash"), good.find("rt:shardBy"), good.find("rt:shardWindow"),
          good.find("rt:seed"), good.find("worldToNDC"), good.size() - 60}) {
        ASSERT_LT(at, good.size());
        for (const std::size_t behind : {0u, 30u, 31u, 32u}) {
            std::string bad = good;
            bad[at + behind] = static_cast<char>(bad[at + behind] ^ 4);
            expectBad(bad, "bad.exr");
        }
    }
    // Whole, but with other pixels than were rendered.
    Image edited = readExr(out.file("p2.exr"));
    edited.channels[0].values[5] += 1.0f;
    writeImage(out.file("bad.exr"), edited);
    expectRefusal({out.file("bad.exr"), shards[1]}, "bad.exr: is damaged, or was changed");
    edited = readExr(out.file("p2.exr"));
    edited.frame->y = 0;
    writeImage(out.file("bad.exr"), edited);
    expectRefusal({out.file("bad.exr"), shards[1]}, "pixels at 0,0 are not those of shard 2/2");
    render("whole.exr", {"--size", "24x64"});
    expectRefusal({out.file("whole.exr"), shards[1]}, "whole.exr: is no shard of a picture");
}

TEST_F(ShardCommand, ShardsGoOnFromTheirCheckpointsOnly) {
    const Arguments picture = {"--size", "32x64", "--spp"};
    const auto shard = [&](const std::string& spp, const std::string& which, const std::string& kind,
                           const Arguments& more) {
        return trace(Arguments{"-o", out.file(fmt::format("c{}.exr", which[0])), "--reproducible", "--shard",
                               which, "--shard-by", kind} +
                     picture + Arguments{spp} + more);
    };
    for (const std::string kind : {"parts", "samples"}) {
        render("whole.exr", picture + Arguments{"8", "--shard", "2/2", "--shard-by", kind});
        ASSERT_EQ(shard("8", "2/2", kind, {"--checkpoint", out.file("c")}).exitCode, 0);
        ASSERT_EQ(shard("8", "2/2", kind, {"--resume", out.file("c")}).exitCode, 0);
        EXPECT_TRUE(bytesOf("c2.exr") == bytesOf("whole.exr")) << kind;
        const CommandResult other = shard("8", "1/2", kind, {"--resume", out.file("c")});
        EXPECT_EQ(other.exitCode, 4) << other.err;
        EXPECT_THAT(other.err, HasSubstr(kind == "parts" ? "its part is 0,32,32,64; see --crop and --shard"
                                                         : "the number of the first"));
    }
}

TEST_F(ShardCommand, TimesAreSummedAndTimeLimitsAreEachShardsOwn) {
    for (const int which : {1, 2})
        ASSERT_EQ(trace({"-o", out.file(fmt::format("p{}.exr", which)), "--size", "16x64", "--spp", "1000000",
                         "--time-limit", "0.1", "--shard", fmt::format("{}/2", which)})
                      .exitCode,
                  0);
    const Image a = readExr(out.file("p1.exr")), b = readExr(out.file("p2.exr"));
    merge({out.file("p1.exr"), out.file("p2.exr")}, {"-o", out.file("m.exr"), "--json", out.file("m.json")});
    const Image merged = readExr(out.file("m.exr"));
    EXPECT_FLOAT_EQ(merged.floats.at("renderTimeSeconds"),
                    a.floats.at("renderTimeSeconds") + b.floats.at("renderTimeSeconds"));
    EXPECT_EQ(merged.ints.at("samplesPerPixel"),
              std::max(a.ints.at("samplesPerPixel"), b.ints.at("samplesPerPixel")));
    const auto json = nlohmann::json::parse(bytesOf("m.json"));
    EXPECT_EQ(json.at("shards"), 2);
    EXPECT_EQ(json.at("height"), 64);
    EXPECT_GT(json.at("renderTimeSeconds"), 0.0);
}

TEST_F(ShardCommand, WhatCannotBeSharedIsUsage) {
    expectUsage({"--shard", "0/2"}, "--shard: '0/2' is no shard such as 1/4");
    for (const char* const bad : {"3/2", "1", "1/", "/2", "a/2", "1/2x", "1/-2", "1/99999999999"})
        expectUsage({"--shard", bad}, "is no shard such as 1/4");
    expectUsage({"--size", "64x70", "--shard", "1/4"}, "70 rows of pixels make no more than 3 shards");
    expectUsage({"--shard", "1/4", "--spp", "3", "--shard-by", "samples"},
                "3 samples per pixel make no more than 3 shards");
    expectUsage({"--shard-by", "samples"}, "--shard-by needs --shard");
    expectUsage({"--shard", "1/2", "--shard-by", "tiles"}, "--shard-by");
    const Arguments bySamples = {"--shard", "1/2", "--spp", "9", "--shard-by", "samples"};
    expectUsage(bySamples + Arguments{"--target-error", "0.1"}, "--target-error");
    expectUsage(bySamples + Arguments{"--time-limit", "3"}, "--time-limit");
    expectUsage(bySamples + Arguments{"--heat", "steps", "--heat-max", "3"}, "--heat");
    expectUsage({"--shard", "1/2", "--heat", "steps"}, "--shard with --heat needs --heat-max");
    expectUsage({"--shard", "1/2", "--rays", "r"}, "--shard does not go with --rays");
    const CommandResult png = trace({"-o", out.file("a.png"), "--shard", "1/2"});
    EXPECT_EQ(png.exitCode, 2) << png.err;
    EXPECT_THAT(png.err, HasSubstr("--shard needs an .exr"));
}

TEST_F(ShardCommand, MergeChecksItsCommandLine) {
    const Arguments shards = renderShards(2, {"--size", "16x64"});
    const auto expectCode = [&](const Arguments& arguments, int exitCode, const std::string& message) {
        const CommandResult result = run(Arguments{"merge"} + arguments);
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
    };
    const std::string before = bytesOf("p1.exr");
    expectCode(shards + Arguments{"-o", shards[0]}, 2, "is an input and an output");
    EXPECT_TRUE(bytesOf("p1.exr") == before);
    expectCode(shards, 2, "--output is required");
    expectCode({"-o", out.file("m.exr")}, 2, "shards is required");
    expectCode(shards + Arguments{"-o", out.file("m.tif")}, 2, "pictures end in .exr or .png");
    expectCode(shards + Arguments{"-o", out.file("m.exr"), "--exposure", "1"}, 2, "--exposure needs a .png");
    expectCode(shards + Arguments{"-o", out.file("m.exr"), "--max-memory", "9K"}, 5, "the limit is 0 MiB");
    expectCode({shards[0], out.file("none.exr"), "-o", out.file("m.exr")}, 3, "none.exr: cannot open");
    expectCode(shards + Arguments{"-o", out.file("none/m.exr")}, 3, "none/m.exr");
    EXPECT_FALSE(std::filesystem::exists(out.file("m.exr")));
    EXPECT_THAT(run({"merge", "--help"}).out, HasSubstr("Needs no GPU"));
    EXPECT_THAT(run({"--help"}).out, HasSubstr("rt-trace merge --help"));
}

// Several processes share the software renderer and the folder of compiled shaders; merging opens no device.
TEST_F(ShardCommand, ShardsRunSideBySideAndMergingNeedsNoDevice) {
    const std::string common = folder->file("s.rtatlas") + " -q --reproducible --size 96x128 --spp 4";
    std::string script =
        "export RT_DEVICE=software; unset RT_NO_SHADER_CACHE; export XDG_CACHE_HOME=" + out.file("cache") +
        "; for i in 1 2 3 4; do " RT_BIN_DIR "/rt-trace " + common + " --shard $i/4 -o " +
        out.file("p$i.exr") + " & done; wait";
    const CommandResult all = test::runCommand({"/bin/sh", "-c", script});
    EXPECT_EQ(all.err, "");
    render("whole.exr", {"--size", "96x128", "--spp", "4", "--device", "software"});
    const CommandResult merged =
        run({"merge", out.file("p1.exr"), out.file("p2.exr"), out.file("p3.exr"), out.file("p4.exr"), "-o",
             out.file("m.exr")},
            {"RT_DEVICE=no such device", "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null"});
    EXPECT_EQ(merged.exitCode, 0) << merged.err;
    EXPECT_TRUE(bytesOf("m.exr") == bytesOf("whole.exr"));
}

TEST_F(ShardCommand, TheEnvironmentNamesTheDevice) {
    const Arguments picture = {folder->file("s.rtatlas"), "-o", out.file("a.exr"), "--size", "8"};
    const auto expectCode = [&](const std::string& variable, const Arguments& more, int exitCode,
                                const std::string& message) {
        const CommandResult result = run(picture + more, {variable});
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_THAT(result.err, HasSubstr(message));
    };
    expectCode("RT_DEVICE=software", {}, 0, "software");
    expectCode("RT_DEVICE=", {}, 0, "device ");
    expectCode("RT_DEVICE=gpu", {}, 2, "RT_DEVICE: 'gpu' is none of auto, software");
    expectCode("RT_DEVICE=cuda:", {}, 2, "RT_DEVICE: 'cuda:'");
    expectCode("RT_DEVICE=cuda:998", {}, 6, "RT_DEVICE=cuda:998: no device has this CUDA number");
    expectCode("RT_DEVICE=999", {}, 6, "RT_DEVICE=999: there are ");
    expectCode("RT_DEVICE=999", {"--device", "software"}, 0, "software");
    expectCode("RT_DEVICE=software", {"--device", "cuda:998"}, 6, "--device cuda:998");
    const auto json = nlohmann::json::parse(run({"--list-devices", "--json", "-"}).out);
    for (const nlohmann::json& device : json.at("devices"))
        EXPECT_TRUE(device.contains("problem") || device.contains("cudaDevice"));
}

} // namespace
} // namespace rt
