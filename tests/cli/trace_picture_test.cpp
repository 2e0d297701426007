// rt-trace's pictures as a user makes them: parts, samples, channels, colours.
#include "formats/recipe.h"
#include "tests/cli/picture_command.h"

namespace rt {
namespace {

using test::CommandResult;
using test::PictureCommand;
using testing::HasSubstr;

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
