#include "formats/image.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// Runs rt-compare in a folder with a few images of 2x1 pixels.
class CompareCli : public testing::Test {
protected:
    CompareCli() {
        write("zero.exr", {0.25f, 0.0f});
        write("half.exr", {0.25f, 0.5f});
        write("nan.exr", {0.25f, std::numeric_limits<float>::quiet_NaN()});
    }

    void write(const char* name, const std::vector<float>& values) {
        Image image;
        image.width = 2;
        image.height = 1;
        for (const char* channel : {"B", "G", "R"})
            image.channels.push_back({channel, ImageChannel::Type::Float, values, {}});
        image.channels.push_back({"id", ImageChannel::Type::Uint, {}, {1u, values[1] > 0.0f ? 2u : 1u}});
        writeImage(folder_.file(name), image);
    }

    CommandResult compare(std::vector<std::string> arguments, const std::string& input = "") {
        for (std::string& argument : arguments)
            if (argument.ends_with(".exr") || argument.ends_with(".json")) argument = folder_.file(argument);
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-compare");
        return runCommand(arguments, input);
    }

    static void expectError(const CommandResult& result, int exitCode, const std::string& message) {
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_THAT(result.err, StartsWith("rt-compare: error: "));
        EXPECT_THAT(result.err, HasSubstr(message));
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
        EXPECT_THAT(result.out, IsEmpty());
    }

    TemporaryFolder folder_;
};

TEST_F(CompareCli, EqualImagesPassWithExitCode0) {
    const CommandResult result = compare({"zero.exr", "zero.exr"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, HasSubstr("verdict: pass\n"));
    EXPECT_THAT(result.out, HasSubstr(folder_.file("zero.exr") + ": 2 x 1 pixels"));
    EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(CompareCli, DifferentImagesFailWithExitCode1) {
    const CommandResult result = compare({"zero.exr", "half.exr"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("RMSE 0.353553391")); // 0.5 / sqrt(2)
    EXPECT_THAT(result.out, HasSubstr("worst: R at x 1, y 0: a 0, b 0.5"));
    EXPECT_THAT(result.out, HasSubstr("id: 1 of 2 pixels differ"));
    EXPECT_THAT(result.out, HasSubstr("verdict: fail\n"));
}

TEST_F(CompareCli, MaxRmseMovesTheVerdict) {
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "0.36", "--ignore-channels", "id"}).exitCode, 0);
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "0.35", "--ignore-channels", "id"}).exitCode, 1);
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "0.36"}).exitCode, 1); // ids differ
}

TEST_F(CompareCli, ABlackFrameFailsWithinAnyLimit) {
    write("black.exr", {0.0f, 0.0f});
    const CommandResult result = compare({"black.exr", "zero.exr", "--max-rmse", "1e30"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("fails: black: color: the first image is black everywhere"));
    EXPECT_EQ(compare({"black.exr", "zero.exr", "--max-rmse", "1e30", "--allow", "black,camera"}).exitCode,
              0);
}

TEST_F(CompareCli, NonFinitePixelsNeverPass) {
    EXPECT_EQ(compare({"nan.exr", "nan.exr", "--max-rmse", "1e30"}).exitCode, 1);
    EXPECT_EQ(compare({"zero.exr", "nan.exr", "--max-rmse", "1e30"}).exitCode, 1);
}

TEST_F(CompareCli, JsonHoldsTheFiguresAndLeavesNoFileOnErrors) {
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--json", "report.json"}).exitCode, 1);
    const auto report = nlohmann::json::parse(readText(folder_.file("report.json")));
    EXPECT_EQ(report.at("schemaVersion"), 2);
    EXPECT_EQ(report.at("verdict"), "fail");
    const auto& pair = report.at("pairs").at(0);
    const auto& color = pair.at("layers").at(0);
    EXPECT_NEAR(color.at("rmse").get<double>(), 0.35355339059327379, 1e-15);
    EXPECT_EQ(color.at("compared"), 6);
    EXPECT_EQ(color.at("worst").at(0).at("x"), 1);
    EXPECT_EQ(pair.at("layers").at(1).at("channels").at(0).at("differing"), 1);
    EXPECT_EQ(pair.at("a").at("file"), folder_.file("zero.exr"));
    EXPECT_EQ(compare({"zero.exr", "absent.exr", "--json", "other.json"}).exitCode, 3);
    EXPECT_THAT(readText(folder_.file("other.json")), IsEmpty());
}

TEST_F(CompareCli, JsonOnStandardOutputIsAlone) {
    const CommandResult result = compare({"zero.exr", "nan.exr", "--json", "-"});
    EXPECT_EQ(result.exitCode, 1);
    const auto report = nlohmann::json::parse(result.out);
    const auto& b = report.at("pairs").at(0).at("b");
    EXPECT_EQ(b.at("nan"), 3);
    EXPECT_EQ(b.at("nonFinitePixels"), 1);
    EXPECT_EQ(b.at("firstNonFinite").at("x"), 1);
}

TEST_F(CompareCli, StandardInputIsAnImage) {
    EXPECT_EQ(compare({"-", "zero.exr"}, readText(folder_.file("zero.exr"))).exitCode, 0);
    expectError(compare({"-", "-"}), 2, "standard input");
}

TEST_F(CompareCli, QuietLeavesTheExitCode) {
    const CommandResult result = compare({"-q", "zero.exr", "half.exr"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, IsEmpty());
}

TEST_F(CompareCli, WrongUsageIsExitCode2) {
    expectError(compare({}), 2, "");
    expectError(compare({"zero.exr"}), 2, "");
    expectError(compare({"zero.exr", ""}), 2, "empty");
    expectError(compare({"zero.exr", "zero.exr", "zero.exr"}), 2, "");
    expectError(compare({"zero.exr", "half.exr", "--json", "half.exr"}), 2, "is an input and an output");
    expectError(compare({"zero.exr", "--list", "pairs"}), 2, "--list");
    expectError(compare({"zero.exr", "zero.exr", "--self-test"}), 2, "--self-test takes one image");
    expectError(compare({"zero.exr", "zero.exr", "--allow", "everything"}), 2,
                "--allow: everything not in {size,");
    expectError(compare({"zero.exr", "zero.exr", "--allow-nonfinite", "all"}), 2,
                "--allow-nonfinite: all not in {same}");
    expectError(compare({"zero.exr", "zero.exr", "--crop", "0,0,0,1"}), 2, "is no rectangle");
    expectError(compare({"zero.exr", "zero.exr", "--max-percentile", "0.1"}), 2, "--max-percentile");
    expectError(compare({"zero.exr", "zero.exr", "--max-over", "0.1:2"}), 2, "<= 1");
    expectError(compare({"zero.exr", "zero.exr", "--no-such-option"}), 2, "--no-such-option");
    for (const char* limit : {"nan", "inf", "-1", "x"})
        expectError(compare({"zero.exr", "zero.exr", "--max-rmse", limit}), 2, "--max-rmse");
}

TEST_F(CompareCli, FilesThatCannotBeReadAreExitCode3) {
    expectError(compare({"zero.exr", "absent.exr"}), 3, "absent.exr: cannot open");
    expectError(compare({"zero.exr", folder_.file(".")}), 3, "is a directory");
}

TEST_F(CompareCli, LimitsMayNameLayersAndFigures) {
    EXPECT_EQ(
        compare({"zero.exr", "half.exr", "--max-rmse", "color=0.36", "--max-differing", "id=0.5"}).exitCode,
        0);
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "color=0.36"}).exitCode, 1); // ids differ
    const auto withoutIds = [&](std::vector<std::string> limits) {
        limits.insert(limits.begin(), {"zero.exr", "half.exr", "--ignore-channels", "id"});
        return compare(limits).exitCode;
    };
    EXPECT_EQ(withoutIds({"--max-abs", "0.5", "--max-over", "0.4:0.5"}), 0);
    EXPECT_EQ(withoutIds({"--max-percentile", "50:0", "--min-psnr", "9"}), 0);
    EXPECT_EQ(withoutIds({"--min-psnr", "9.1"}), 1); // 9.03 dB
    EXPECT_EQ(withoutIds({"--max-rmse", "1e-3", "--max-rmse", "5"}), 1) << "the strictest counts";
    EXPECT_EQ(withoutIds({"--min-psnr", "9.1", "--min-psnr", "9"}), 1);
    const CommandResult result = compare({"zero.exr", "half.exr", "--max-rmse", "1", "--max-abs", "R=0.1"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("fails: limit: R: maximum |a-b| 0.5 exceeds 0.1\n"));
}

TEST_F(CompareCli, MasksRectanglesAndCropsLeaveOutWhatDiffers) {
    write("mask.exr", {1.0f, 0.0f});
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--mask", "mask.exr"}).exitCode, 0);
    EXPECT_EQ(compare({"zero.exr", "nan.exr", "--ignore", "1,0,2,1"}).exitCode, 0);
    EXPECT_EQ(compare({"zero.exr", "nan.exr", "--ignore", "0,0,1,1"}).exitCode, 1);
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--crop", "0,0,1,1"}).exitCode, 0);
    const CommandResult result = compare({"zero.exr", "half.exr", "--crop", "1,0,2,1"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("worst: R at x 1, y 0: a 0, b 0.5"));
    EXPECT_EQ(compare({"nan.exr", "nan.exr", "--allow-nonfinite", "same"}).exitCode, 0);
}

TEST_F(CompareCli, FoldersAreComparedByRelativeName) {
    const auto put = [&](const char* from, const std::string& to) {
        std::filesystem::create_directories(std::filesystem::path(folder_.file(to)).parent_path());
        std::filesystem::copy_file(folder_.file(from), folder_.file(to));
    };
    put("zero.exr", "a/one.exr");
    put("zero.exr", "b/one.exr");
    put("zero.exr", "a/deep/two.exr");
    put("zero.exr", "b/deep/two.exr");
    std::ofstream(folder_.file("a/notes.txt")) << "no picture";
    const std::string a = folder_.file("a"), b = folder_.file("b");
    CommandResult result = compare({a, b});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("2 pairs: 2 pass, 0 differ, 0 without a verdict\n"));
    EXPECT_THAT(result.err, HasSubstr("1 files are not compared"));
    EXPECT_THAT(result.err, HasSubstr("a/notes.txt"));
    result = compare({a, b, "--json", b + "/one.exr"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("b/one.exr is an input and an output"));
    put("half.exr", "a/extra.exr");
    result = compare({a, b});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("a/extra.exr: is only among the first images"));
    EXPECT_EQ(compare({a, b, "--allow", "files"}).exitCode, 0);
    put("half.exr", "b/extra.exr");
    put("half.exr", "b/missing.exr");
    EXPECT_THAT(compare({a, b}).out, HasSubstr("b/missing.exr: is only among the second images"));
    put("zero.exr", "a/missing.exr");
    result = compare({a, b});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("4 pairs: 3 pass, 1 differ, 0 without a verdict\n"));
    std::ofstream(folder_.file("a/one.exr")) << "broken";
    result = compare({a, b});
    EXPECT_EQ(result.exitCode, 4) << "no verdict on one pair is worse than a difference";
    EXPECT_THAT(result.out, HasSubstr("a/one.exr: is not an OpenEXR file"));
    EXPECT_THAT(result.out, HasSubstr("4 pairs: 2 pass, 1 differ, 1 without a verdict\n"));
    std::filesystem::create_directory(folder_.file("empty"));
    result = compare({a, folder_.file("empty"), "--allow", "files"});
    EXPECT_EQ(result.exitCode, 1) << "nothing was compared";
    std::filesystem::create_directory_symlink(folder_.file("b"), folder_.file("empty/link"));
    EXPECT_THAT(compare({folder_.file("empty"), folder_.file("empty")}).out, HasSubstr("4 pairs: 4 pass"));
    std::filesystem::remove(folder_.file("empty/link"));
    std::filesystem::create_symlink("nowhere.exr", folder_.file("empty/broken.exr"));
    EXPECT_EQ(compare({folder_.file("empty"), folder_.file("empty")}).exitCode, 3);
    std::filesystem::remove(folder_.file("empty/broken.exr"));
    expectError(compare({folder_.file("empty"), folder_.file("empty")}), 4, "hold no pictures");
}

TEST_F(CompareCli, SequencesArePairedByNumber) {
    for (const char* name : {"a.0001.exr", "a.0002.exr", "b.0001.exr", "b.0002.exr"})
        write(name, {0.0f, 0.0f});
    write("a.12345.exr", {0.0f, 0.0f});
    write("a.3.exr", {0.0f, 0.0f}); // not of four digits
    write("b.12345.exr", {0.0f, 1.0f});
    CommandResult result = compare({"a.%04d.exr", "b.%04d.exr"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("3 pairs: 2 pass, 1 differ"));
    EXPECT_THAT(result.err, HasSubstr("12342 numbers between the first and the last"));
    write("b.0003.exr", {0.0f, 0.0f});
    EXPECT_THAT(compare({"a.%04d.exr", "b.%04d.exr"}).out,
                HasSubstr("b.0003.exr: is only among the second images"));
    expectError(compare({"c.%04d.exr", "d.%04d.exr"}), 4, "hold no pictures");
}

TEST_F(CompareCli, AListNamesThePairs) {
    const std::string list = "# frames\n" + folder_.file("zero.exr") + "\t" + folder_.file("zero.exr") +
                             "\n\n" + folder_.file("zero.exr") + "  " + folder_.file("half.exr") + "\r\n";
    std::ofstream(folder_.file("pairs")) << list;
    const CommandResult result = compare({"--list", folder_.file("pairs")});
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_THAT(result.out, HasSubstr("2 pairs: 1 pass, 1 differ"));
    EXPECT_EQ(compare({"--list", "-"}, list).exitCode, 1);
    expectError(compare({"--list", "-"}, "one\n"), 4, "standard input: line 1 does not name two files");
    expectError(compare({"--list", "-"}, ""), 4, "names no files");
    expectError(compare({"--list", "/dev/zero"}), 5, "lists of more than 64 MiB");
}

TEST_F(CompareCli, SelfTestShowsThatEveryFaultIsCaught) {
    CommandResult result = compare({"--self-test", "half.exr"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    for (const char* fault :
         {"one NaN", "all NaN", "one +Inf", "black frame", "shift by one pixel", "gamma 2.2 applied",
          "error of 1 %", "error of 1 ulp", "channel renamed", "channel of zeros added"})
        EXPECT_THAT(result.out,
                    testing::ContainsRegex(
                        std::string(fault == std::string("one +Inf") ? "one .Inf" : fault) + " +caught +ok"));
    EXPECT_THAT(result.out, HasSubstr("channels swapped        -            ok        changes nothing"));
    result = compare({"--self-test", "half.exr", "--max-rmse", "0.004"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.out, testing::ContainsRegex("error of 1 % +below limits +ok"));
    EXPECT_THAT(result.out, testing::ContainsRegex("gamma 2.2 applied +caught +ok"));
    write("black.exr", {0.0f, 0.0f}); // in which an error of 1 ulp is no black any more
    EXPECT_EQ(compare({"--self-test", "black.exr"}).exitCode, 0);
    EXPECT_EQ(compare({"--self-test", "black.exr", "--max-rmse", "1"}).exitCode, 0);
    expectError(compare({"--self-test", "nan.exr"}), 4, "does not pass against itself");
}

TEST_F(CompareCli, TheSameFileTwiceIsNoted) {
    EXPECT_THAT(compare({"half.exr", "half.exr"}).out, HasSubstr("note: both names are the same file"));
    EXPECT_THAT(compare({"half.exr", "zero.exr"}).out, testing::Not(HasSubstr("the same file")));
}

TEST_F(CompareCli, LimitsOfTwoNumbersSayHowTheyAreWritten) {
    expectError(compare({"half.exr", "half.exr", "--max-over", "0.1"}), 2,
                "'0.1' is not two numbers with a colon");
    expectError(compare({"half.exr", "half.exr", "--max-over", "0.1:2"}), 2, "<= 1");
}

TEST_F(CompareCli, AnOutputInTheFolderOfSecondRendersIsRefused) {
    std::filesystem::create_directory(folder_.file("second"));
    write("second/half.exr", {0.25f, 0.25f});
    const std::string before = readText(folder_.file("second/half.exr"));
    expectError(compare({"zero.exr", "half.exr", "--second-seed", folder_.file("second"), "--json",
                         "second/half.exr"}),
                2, "is an input and an output");
    EXPECT_EQ(readText(folder_.file("second/half.exr")), before);
}

// As two seeds' renders of something grey.
void writeNoise(const std::string& path, unsigned seed, float gain) {
    Image image;
    image.width = image.height = 128;
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0.0f, 0.05f);
    for (const char* channel : {"B", "G", "R"}) {
        std::vector<float> values(image.pixelCount());
        for (float& value : values) value = gain * (0.5f + noise(random));
        image.channels.push_back({channel, ImageChannel::Type::Float, values, {}});
    }
    writeImage(path, image);
}

TEST_F(CompareCli, NoiseIsJudgedAsNoise) {
    writeNoise(folder_.file("seed1.exr"), 1, 1.0f);
    writeNoise(folder_.file("seed2.exr"), 2, 1.0f);
    writeNoise(folder_.file("seed3.exr"), 3, 1.0f);
    writeNoise(folder_.file("brighter.exr"), 2, 1.02f);
    const CommandResult result = compare({"seed1.exr", "seed2.exr", "--second-seed", "seed3.exr"});
    EXPECT_EQ(result.exitCode, 0) << result.out;
    EXPECT_EQ(compare({"seed1.exr", "brighter.exr", "--second-seed", "seed3.exr"}).exitCode, 1);
    const CommandResult untested = compare({"seed1.exr", "seed2.exr", "--noise"});
    EXPECT_EQ(untested.exitCode, 1);
    EXPECT_THAT(untested.out, HasSubstr("fails: noise: R, G, B differ, and the noise of single pixels is not "
                                        "known (regions only: there is no variance channel"));
    EXPECT_THAT(untested.out, HasSubstr("render both with --aov Z,N,id,variance, give --second-seed"));
    EXPECT_EQ(compare({"seed1.exr", "seed1.exr", "--noise"}).exitCode, 0);
    EXPECT_EQ(compare({"seed1.exr", "seed2.exr"}).exitCode, 1);
    write("noise.exr", {0.25f, 0.001f});
    EXPECT_EQ(compare({"zero.exr", "noise.exr", "--noise"}).exitCode, 1) << "too few pixels to tell";
    expectError(compare({"zero.exr", "noise.exr", "--second-seed", "absent.exr"}), 3, "absent.exr");
}

TEST_F(CompareCli, LimitsOfReadingAreExitCode5) {
    expectError(compare({"zero.exr", "zero.exr", "--max-pixels", "1"}), 5, "2 x 1 pixels exceed 1");
}

TEST_F(CompareCli, DamagedFilesOfTheCollectionEndInALine) {
    const std::string folder = scenePath("images/exr_damaged");
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no scenes";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const CommandResult result =
            runCommand({RT_BIN_DIR "/rt-compare", entry.path().string(), folder_.file("zero.exr")});
        EXPECT_TRUE(result.exitCode == 4 || result.exitCode == 5) << entry.path() << result.err;
        EXPECT_THAT(result.err, HasSubstr(entry.path().filename().string()));
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
        ++files;
    }
    EXPECT_GE(files, 80);
}

TEST_F(CompareCli, FilesThatAreNotPicturesAreExitCode4) {
    std::ofstream(folder_.file("empty.exr"));
    std::ofstream(folder_.file("text.exr")) << "not a picture at all";
    std::ofstream(folder_.file("cut.exr"), std::ios::binary)
        << readText(folder_.file("zero.exr")).substr(0, 400);
    expectError(compare({"zero.exr", "empty.exr"}), 4, "empty.exr: is not an OpenEXR file");
    expectError(compare({"text.exr", "zero.exr"}), 4, "text.exr: is not an OpenEXR file");
    expectError(compare({"cut.exr", "zero.exr"}), 4, "cut.exr: ");
}

TEST_F(CompareCli, HelpShowsTheExitCodes) {
    const CommandResult result = compare({"--help"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, HasSubstr("images differ"));
    EXPECT_EQ(compare({"--version"}).exitCode, 0);
}

} // namespace
} // namespace rt::test
