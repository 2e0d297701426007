#include "formats/image.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <limits>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// Runs rt-compare in a folder with a few images of 2x1 pixels.
class CompareCli : public testing::Test {
protected:
    CompareCli() {
        write("zero.exr", {0.0f, 0.0f});
        write("half.exr", {0.0f, 0.5f});
        write("nan.exr", {0.0f, std::numeric_limits<float>::quiet_NaN()});
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
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "0.36"}).exitCode, 0);
    EXPECT_EQ(compare({"zero.exr", "half.exr", "--max-rmse", "0.35"}).exitCode, 1);
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
    expectError(compare({"zero.exr", "zero.exr", "--no-such-option"}), 2, "--no-such-option");
    for (const char* limit : {"nan", "inf", "-1", "x"})
        expectError(compare({"zero.exr", "zero.exr", "--max-rmse", limit}), 2, "--max-rmse");
}

TEST_F(CompareCli, FilesThatCannotBeReadAreExitCode3) {
    expectError(compare({"zero.exr", "absent.exr"}), 3, "absent.exr: cannot open");
    expectError(compare({"zero.exr", folder_.file(".")}), 3, "is a directory");
}

TEST_F(CompareCli, FilesThatAreNotExrAreExitCode4) {
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
