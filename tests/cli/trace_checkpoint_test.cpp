// rt-trace's pictures that are interrupted and go on.
#include "formats/checkpoint_file.h"
#include "tests/cli/picture_command.h"

#include <fstream>

namespace rt {
namespace {

using test::CommandResult;
using test::PictureCommand;
using testing::HasSubstr;

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

} // namespace
} // namespace rt
