#include "formats/image.h"
#include "tests/support/read_text.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

namespace rt::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::uint32_t kWidth = 48, kHeight = 32;
constexpr const char* kOddName = "<img src=x onerror=alert(1)>&.exr";

// Runs rt-compare in a folder with two linear pictures, of which one is disturbed in a square.
class CompareReports : public testing::Test {
protected:
    CompareReports() {
        write("reference.exr", 0.0f);
        write("test.exr", 0.25f);
        write(kOddName, 0.25f);
    }

    void write(const std::string& name, float amount) {
        Image image;
        image.width = kWidth;
        image.height = kHeight;
        for (int c = 0; c < 3; ++c) {
            ImageChannel channel{std::string(1, "BGR"[c]), ImageChannel::Type::Float, {}, {}};
            for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
                const std::uint32_t x = i % kWidth, y = i / kWidth;
                const bool isSquare = x >= 20 && x < 28 && y >= 10 && y < 18;
                channel.values.push_back(float(x * (c + 1)) / 64.0f + (isSquare ? amount : 0.0f));
            }
            image.channels.push_back(std::move(channel));
        }
        if (amount > 0.0f)
            image.channels[1].values[12 * kWidth + 22] = std::numeric_limits<float>::quiet_NaN();
        writeImage(folder_.file(name), image);
    }

    CommandResult compare(std::vector<std::string> arguments) {
        for (std::string& argument : arguments)
            if (argument.find('.') != std::string::npos && !argument.starts_with("0."))
                argument = folder_.file(argument);
        arguments.insert(arguments.begin(), RT_BIN_DIR "/rt-compare");
        return runCommand(arguments);
    }

    void expectUsageError(const std::vector<std::string>& arguments, const std::string& message) {
        const CommandResult result = compare(arguments);
        EXPECT_EQ(result.exitCode, 2) << result.out;
        EXPECT_THAT(result.err, StartsWith("rt-compare: error: "));
        EXPECT_THAT(result.err, HasSubstr(message));
    }

    TemporaryFolder folder_;
};

TEST_F(CompareReports, LimitsOnFlipAndSimilarityMoveTheVerdict) {
    EXPECT_EQ(compare({"reference.exr", "reference.exr", "--max-flip", "0", "--min-ssim", "1"}).exitCode, 0);
    write("near.exr", -0.2f); // no NaN in it
    EXPECT_EQ(compare({"near.exr", "reference.exr", "--max-flip", "0.5", "--min-ssim", "0.1"}).exitCode, 0);
    const CommandResult flip = compare({"near.exr", "reference.exr", "--max-flip", "0.001"});
    EXPECT_EQ(flip.exitCode, 1);
    EXPECT_THAT(flip.out, HasSubstr("FLIP (HDR): mean 0."));
    EXPECT_THAT(flip.out, HasSubstr("color: FLIP 0."));
    EXPECT_EQ(compare({"near.exr", "reference.exr", "--min-ssim", "0.999"}).exitCode, 1);
    const CommandResult blind =
        compare({"near.exr", "reference.exr", "--max-flip", "1", "--exposures=-100,-100"});
    EXPECT_EQ(blind.exitCode, 1);
    EXPECT_THAT(blind.out, HasSubstr("color: FLIP could not be computed; limit"));
    EXPECT_THAT(blind.out, HasSubstr("at none of the exposures"));
    EXPECT_EQ(compare({"near.exr", "reference.exr", "--max-flip", "1", "--exposures=-8,0"}).exitCode, 0);
    const CommandResult small = compare({"near.exr", "reference.exr", "--min-ms-ssim", "0.1"});
    EXPECT_EQ(small.exitCode, 1); // not defined for so small a picture: no pass
    EXPECT_THAT(small.out, HasSubstr("no MS-SSIM"));
}

TEST_F(CompareReports, FlipRunsOnlyIfAskedForAndTakesItsOptions) {
    EXPECT_THAT(compare({"test.exr", "reference.exr"}).out, Not(HasSubstr("FLIP")));
    const CommandResult result =
        compare({"test.exr", "reference.exr", "--metrics", "flip,ssim", "--exposures", "-1,2",
                 "--pixels-per-degree", "30", "--json", "r.json"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.out, HasSubstr("at 30 pixels per degree, 3 exposures from -1 to 2 stops"));
    const auto report = nlohmann::json::parse(readText(folder_.file("r.json")));
    const auto& layer = report.at("pairs").at(0).at("layers").at(0);
    EXPECT_GT(layer.at("flip").at("mean"), 0.001);
    EXPECT_EQ(layer.at("flip").at("exposures"), 3);
    EXPECT_LT(layer.at("ssim"), 0.999);
}

TEST_F(CompareReports, ErrorMapsAreWrittenInBothFormatsTheSameEachTime) {
    EXPECT_EQ(compare({"test.exr", "reference.exr", "-o", "map.exr", "-o", "map.png", "-q"}).exitCode, 1);
    const std::string exr = readText(folder_.file("map.exr")), png = readText(folder_.file("map.png"));
    EXPECT_THAT(png, StartsWith("\x89PNG"));
    for (const char* channel : {"error.R", "error.G", "error.B", "flip"})
        EXPECT_THAT(exr, HasSubstr(channel));
    EXPECT_EQ(compare({"test.exr", "reference.exr", "-o", "again.exr", "-q", "-j", "1"}).exitCode, 1);
    EXPECT_EQ(readText(folder_.file("again.exr")), exr);
    EXPECT_EQ(compare({"test.exr", "reference.exr", "-o", "abs.png", "--heat", "abs", "-q"}).exitCode, 1);
    EXPECT_NE(readText(folder_.file("abs.png")), png);
    EXPECT_EQ(compare({"test.exr", "reference.exr", "-o", "ssim.exr", "--heat", "ssim", "-q"}).exitCode, 1);
    EXPECT_THAT(readText(folder_.file("ssim.exr")), Not(HasSubstr("flip")));
}

TEST_F(CompareReports, JunitNamesFilesAndFailures) {
    EXPECT_EQ(compare({kOddName, "reference.exr", "--junit", "r.xml", "-q"}).exitCode, 1);
    const std::string xml = readText(folder_.file("r.xml"));
    EXPECT_THAT(xml, HasSubstr("failures=\"1\""));
    EXPECT_THAT(xml, HasSubstr("&lt;img src=x onerror=alert(1)&gt;&amp;.exr against "));
    EXPECT_THAT(xml, HasSubstr("1 non-finite values in 1 pixels of the first image"));
    EXPECT_THAT(compare({"test.exr", "reference.exr", "--junit", "-"}).out, StartsWith("<?xml"));
}

TEST_F(CompareReports, WrongUsageIsNamed) {
    expectUsageError({"test.exr", "reference.exr", "-o", "map.jpg"},
                     "map.jpg: error maps are written as .exr or .png");
    expectUsageError({"test.exr", "reference.exr", "--heat", "abs"}, "-o");
    expectUsageError({"test.exr", "reference.exr", "-o", "map.png", "--heat", "psnr"},
                     "--heat: psnr not in {flip,ssim,abs}");
    expectUsageError({"test.exr", "reference.exr", "--metrics", "vmaf"},
                     "--metrics: vmaf not in {flip,ssim,ms-ssim}");
    expectUsageError({"test.exr", "reference.exr", "--exposures", "3,1"}, "--exposures");
    expectUsageError({"test.exr", "reference.exr", "--exposures", "0,1,1000"}, "--exposures");
    expectUsageError({"test.exr", "reference.exr", "--max-flip", "2"}, "--max-flip");
    expectUsageError({"test.exr", "reference.exr", "--html", "test.exr"}, "test.exr");
    expectUsageError({"test.exr", "reference.exr", "--html", "same.x", "--junit", "same.x"}, "same.x");
    expectUsageError({"--self-test", "test.exr", "--html", "p.html"}, "--self-test");
    std::filesystem::create_directory(folder_.file("d.1"));
    std::filesystem::create_directory(folder_.file("d.2"));
    for (const char* name : {"d.1/x.exr", "d.1/y.exr", "d.2/x.exr", "d.2/y.exr"}) write(name, 0.0f);
    expectUsageError({"d.1", "d.2", "--html", "p.html"}, "one pair");
    EXPECT_FALSE(std::filesystem::exists(folder_.file("p.html")));
}

TEST_F(CompareReports, SeveralPairsAreOneFile) {
    std::filesystem::create_directory(folder_.file("d.1"));
    std::filesystem::create_directory(folder_.file("d.2"));
    for (const char* name : {"d.1/x.exr", "d.1/y.exr", "d.2/x.exr"}) write(name, 0.0f);
    write("d.2/y.exr", -0.5f);
    EXPECT_EQ(compare({"d.1", "d.2", "--json", "r.json", "--junit", "r.xml"}).exitCode, 1);
    const auto report = nlohmann::json::parse(readText(folder_.file("r.json")));
    EXPECT_EQ(report.at("verdict"), "fail");
    EXPECT_EQ(report.at("pairs").size(), 2u);
    EXPECT_EQ(report.at("pairs").at(0).at("verdict"), "pass");
    EXPECT_EQ(report.at("pairs").at(1).at("verdict"), "fail");
    EXPECT_THAT(readText(folder_.file("r.xml")), HasSubstr("tests=\"2\" failures=\"1\""));
}

TEST_F(CompareReports, PicturesWithoutCommonPixelsHaveNoErrorMapButAVerdict) {
    Image image;
    image.width = image.height = 1;
    for (const char* name : {"B", "G", "R"})
        image.channels.push_back({name, ImageChannel::Type::Float, {0.5f}, {}});
    writeImage(folder_.file("dot.exr"), image);
    const CommandResult result =
        compare({"dot.exr", "reference.exr", "-o", "map.png", "--html", "page.html"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("map.png: not written, the images have no pixels in common"));
    EXPECT_FALSE(std::filesystem::exists(folder_.file("map.png")));
    EXPECT_THAT(readText(folder_.file("page.html")), HasSubstr("\"layers\":[]"));
}

std::string findChromium() {
    for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"})
        if (std::filesystem::exists(path)) return path;
    return "";
}

// The page as a browser has built it, after its script ran.
std::string domOf(const TemporaryFolder& folder, const std::string& address) {
    const CommandResult result =
        runCommand({findChromium(), "--headless", "--no-sandbox", "--disable-gpu",
                    "--virtual-time-budget=10000", "--user-data-dir=" + folder.file("profile"), "--dump-dom",
                    "file://" + folder.file("page.html") + address});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.out;
}

TEST_F(CompareReports, ThePageShowsFiguresAndPixelsInABrowser) {
    if (findChromium().empty()) GTEST_SKIP() << "no chromium: the page is not tried in a browser";
    EXPECT_EQ(compare({kOddName, "reference.exr", "--html", "page.html", "-q"}).exitCode, 1);
    const std::string dom = domOf(folder_, "#view=flip&stops=2&x=20&y=11");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"true\""));
    EXPECT_THAT(dom, HasSubstr("id=\"problem\" role=\"alert\" hidden"));
    EXPECT_THAT(dom, HasSubstr("<span id=\"verdict\" class=\"fail\">fail</span>"));
    EXPECT_THAT(dom, HasSubstr("&lt;img src=x onerror=alert(1)&gt;&amp;.exr"));
    EXPECT_THAT(dom, Not(HasSubstr("<img")));
    EXPECT_THAT(dom, HasSubstr("<th scope=\"row\">color</th>"));
    EXPECT_THAT(dom, HasSubstr("FLIP of color: 67.0206 pixels per degree"));
    // Half floats hold these values: R (3 x 20 + 16) / 64, G (2 x 20 + 16) / 64, B (20 + 16) / 64.
    EXPECT_THAT(
        dom,
        HasSubstr("color at x 20, y 11\na 1.1875 0.875 0.5625   b 0.9375 0.625 0.3125   a−b 0.25 0.25 0.25"));
    EXPECT_THAT(domOf(folder_, "#x=22&y=12"), HasSubstr("a 1.28125 NaN 0.59375"));
}

TEST_F(CompareReports, ThePageOfPicturesThatCannotBeComparedShowsWhy) {
    if (findChromium().empty()) GTEST_SKIP() << "no chromium: the page is not tried in a browser";
    Image image;
    image.width = image.height = 1;
    image.channels.push_back({"Y", ImageChannel::Type::Float, {0.5f}, {}});
    writeImage(folder_.file("dot.exr"), image);
    EXPECT_EQ(compare({"dot.exr", "reference.exr", "--html", "page.html", "-q"}).exitCode, 1);
    const std::string dom = domOf(folder_, "");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"true\""));
    EXPECT_THAT(dom, HasSubstr("<li class=\"fails\">"));
    EXPECT_THAT(dom, HasSubstr("<section aria-label=\"Pictures\" hidden"));
}

} // namespace
} // namespace rt::test
