#include "tools/rt-compare/compare.h"
#include "tools/rt-compare/heat_map.h"
#include "tools/rt-compare/html_report.h"
#include "tools/rt-compare/json_report.h"
#include "tools/rt-compare/junit_report.h"
#include "tools/rt-compare/pool_errors.h"
#include "tools/rt-compare/ssim.h"
#include "tools/rt-compare/text_report.h"

#include "formats/heat_color.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <numeric>

namespace rt {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Type = ImageChannel::Type;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Picture pictureOf(std::uint32_t width, std::uint32_t height, std::vector<ImageChannel> channels,
                  ValueScale scale = ValueScale::Linear) {
    PicturePart part;
    part.image.width = width;
    part.image.height = height;
    std::ranges::sort(channels, {}, &ImageChannel::name);
    part.image.channels = std::move(channels);
    part.dataWindow =
        part.displayWindow = {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    return {"picture", "EXR", scale, {std::move(part)}};
}

ImageChannel floats(const char* name, std::vector<float> values) {
    return {name, Type::Float, std::move(values), {}};
}

// 2x1 pixels: colours, depth and ids.
Picture small(std::vector<float> red, float depth, std::uint32_t id) {
    return pictureOf(2, 1,
                     {floats("R", std::move(red)),
                      floats("G", {0, 0}),
                      floats("B", {0, 0}),
                      floats("Z", {1, depth}),
                      {"id", Type::Uint, {}, {7, id}}});
}

// 32x24 pixels with a ramp, disturbed by `amount` in one square.
Picture ramp(float amount, ValueScale scale, const char* prefix = "") {
    std::vector<ImageChannel> channels;
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float> values;
        for (int i = 0; i < 32 * 24; ++i) {
            const int x = i % 32, y = i / 32;
            values.push_back(float(x) / 40.0f + (x >= 8 && x < 14 && y >= 8 && y < 14 ? amount : 0.0f));
        }
        channels.push_back(floats((std::string(prefix) + name).c_str(), values));
    }
    return pictureOf(32, 24, std::move(channels), scale);
}

CompareOptions seen() {
    CompareOptions options;
    options.perception.flip = options.perception.ssim = options.perception.ssimMap = true;
    return options;
}

PairResult named(PairResult&& result, std::string nameA = "a.exr") {
    result.nameA = std::move(nameA);
    result.nameB = "b.exr";
    return std::move(result);
}

PairResult unread(std::string nameB, std::string problem, int exitCode) {
    PairResult result;
    result.nameA = "a.exr";
    result.nameB = std::move(nameB);
    result.problem = std::move(problem);
    result.exitCode = exitCode;
    return result;
}

TEST(Perception, IsOnlyComputedWhereItIsAskedFor) {
    const PairResult plain =
        comparePictures(ramp(0.1f, ValueScale::Display), ramp(0.0f, ValueScale::Display), {});
    EXPECT_FALSE(plain.comparison.layers.at(0).flip);
    EXPECT_FALSE(plain.comparison.layers.at(0).ssim);
    EXPECT_TRUE(plain.maps.at(0).flip.empty());
    const PairResult all =
        comparePictures(ramp(0.1f, ValueScale::Display), ramp(0.0f, ValueScale::Display), seen());
    const LayerComparison& layer = all.comparison.layers.at(0);
    ASSERT_TRUE(layer.flip && layer.ssim);
    EXPECT_FALSE(layer.flip->hdr);
    EXPECT_GT(layer.flip->mean, 0.001);
    EXPECT_LT(*layer.ssim, 0.999);
    EXPECT_EQ(layer.flip->mean, poolErrors(all.maps.at(0).flip).mean);
}

TEST(Perception, OfLinearPicturesIsHdrFlipWithTheExposuresReported) {
    CompareOptions options = seen();
    options.perception.exposures = ExposureRange{-1.0, 3.0, 5};
    options.perception.pixelsPerDegree = 40.0;
    const PairResult compared =
        comparePictures(ramp(0.1f, ValueScale::Linear), ramp(0.0f, ValueScale::Linear), options);
    const FlipFigures& flip = compared.comparison.layers.at(0).flip.value();
    EXPECT_TRUE(flip.hdr);
    EXPECT_EQ(flip.startExposure, -1.0);
    EXPECT_EQ(flip.stopExposure, 3.0);
    EXPECT_EQ(flip.exposures, 5);
    EXPECT_EQ(flip.pixelsPerDegree, 40.0);
    EXPECT_EQ(flip.note, "");
    const Image &a = compared.pair->a.parts[0].image, &b = compared.pair->b.parts[0].image;
    const auto planesOf = [](const Image& image) {
        return ColorPlanes{
            32, 24, {image.find("R")->values, image.find("G")->values, image.find("B")->values}};
    };
    EXPECT_EQ(compared.maps.at(0).flip, flipHdr(planesOf(b), planesOf(a), {-1.0, 3.0, 5}, 40.0));
}

TEST(Perception, SimilarityOfLinearPicturesIsThatOfToneMappedOnes) {
    const PairResult compared =
        comparePictures(ramp(7.0f, ValueScale::Linear), ramp(0.0f, ValueScale::Linear), seen());
    std::vector<float> planes[2];
    for (int i = 0; i < 2; ++i)
        for (const float v :
             (i == 0 ? compared.pair->a : compared.pair->b).parts[0].image.find("R")->values) {
            const double unit = v / (1.0 + v);
            planes[i].push_back(static_cast<float>(
                unit <= 0.0031308 ? 12.92 * unit : 1.055 * std::pow(unit, 1 / 2.4) - 0.055));
        }
    EXPECT_NEAR(compared.comparison.layers.at(0).ssim.value(),
                measureSsim({32, 24, planes[0], planes[1], {}}, {.single = true}).single.value(), 1e-5);
}

TEST(Perception, IgnoredPixelsDoNotCount) {
    CompareOptions options = seen();
    options.region.ignored = {{0, 0, 32, 11}}; // the upper half of the disturbed square
    const PairResult compared =
        comparePictures(ramp(0.3f, ValueScale::Display), ramp(0.0f, ValueScale::Display), options);
    std::vector<float> planes[2]; // of the pictures, in which those pixels are black
    for (int i = 0; i < 2; ++i) {
        planes[i] = ramp(i == 0 ? 0.3f : 0.0f, ValueScale::Display).parts[0].image.find("R")->values;
        std::fill_n(planes[i].begin(), 32 * 11, 0.0f);
    }
    const auto colorsOf = [](const std::vector<float>& plane) {
        return ColorPlanes{32, 24, {plane, plane, plane}, ColorPlanes::Encoding::Srgb};
    };
    const std::vector<float> flip = flipLdr(colorsOf(planes[1]), colorsOf(planes[0]));
    const double sum = std::accumulate(flip.begin() + 32 * 11, flip.end(), 0.0);
    std::vector<std::uint8_t> ignored(32 * 24);
    std::fill_n(ignored.begin(), 32 * 11, std::uint8_t(1));
    const LayerComparison& layer = compared.comparison.layers.at(0);
    EXPECT_GT(sum, 1.0);
    EXPECT_NEAR(layer.flip->mean, sum / (32 * 13), 1e-9);
    EXPECT_EQ(compared.maps.at(0).flip[32 * 10 + 10], 0.0f);
    EXPECT_LT(layer.ssim.value(), 0.99);
    EXPECT_NEAR(layer.ssim.value(),
                measureSsim({32, 24, planes[0], planes[1], ignored}, {.single = true}).single.value(), 1e-9);
}

TEST(Perception, SeesLayersAndGreyPictures) {
    const PairResult layered = comparePictures(ramp(0.1f, ValueScale::Linear, "albedo."),
                                               ramp(0.0f, ValueScale::Linear, "albedo."), seen());
    EXPECT_GT(layered.comparison.layers.at(0).flip.value().mean, 0.001);
    std::vector<float> grey(32 * 24, 0.5f), other(32 * 24, 0.6f);
    const PairResult compared =
        comparePictures(pictureOf(32, 24, {floats("Y", grey)}, ValueScale::Display),
                        pictureOf(32, 24, {floats("Y", other)}, ValueScale::Display), seen());
    const std::vector<float> expected = flipLdr({32, 24, {other, other, other}, ColorPlanes::Encoding::Srgb},
                                                {32, 24, {grey, grey, grey}, ColorPlanes::Encoding::Srgb});
    EXPECT_EQ(compared.maps.at(0).flip, expected);
}

TEST(Perception, NotesPicturesThatAreTooSmallForASimilarity) {
    CompareOptions options = seen();
    options.perception.msSsim = true;
    const PairResult compared = comparePictures(small({0, 0}, 1, 7), small({0, 0}, 1, 7), options);
    EXPECT_FALSE(compared.comparison.layers.at(0).ssim);
    EXPECT_THAT(compared.comparison.notes,
                testing::Contains(HasSubstr("no SSIM of a picture of less than 11 x 11")));
    EXPECT_THAT(compared.comparison.notes, testing::Contains(HasSubstr("no MS-SSIM")));
    options.limits.push_back(parseLimit(Metric::Ssim, "0.5"));
    EXPECT_FALSE(comparePictures(small({0, 0}, 1, 7), small({0, 0}, 1, 7), options).comparison.passed());
}

TEST(HeatMap, HoldsTheErrorsOfAllChannelsAndTheirColors) {
    const PairResult compared = comparePictures(small({0, 0.5f}, 3, 8), small({0.25f, 0}, 1, 7), {});
    const Image map = heatMap(*compared.pair, compared.maps, HeatFigure::Abs);
    EXPECT_THAT(map.find("error.R")->values, ElementsAre(0.25f, 0.5f));
    EXPECT_THAT(map.find("error.Z")->values, ElementsAre(0.0f, 2.0f));
    EXPECT_THAT(map.find("error.id")->values, ElementsAre(0.0f, 1.0f));
    EXPECT_FALSE(map.find("flip"));
    const auto expectColor = [&](std::size_t i, double t) {
        const glm::dvec3 color = heatColor(std::round(t * 255.0) / 255.0);
        EXPECT_FLOAT_EQ(map.find("R")->values[i], float(decodeSrgb(color.r)));
        EXPECT_FLOAT_EQ(map.find("G")->values[i], float(decodeSrgb(color.g)));
        EXPECT_FLOAT_EQ(map.find("B")->values[i], float(decodeSrgb(color.b)));
    };
    expectColor(0, 0.5); // of the largest error of the colours
    expectColor(1, 1.0);
}

TEST(HeatMap, ShowsWhatIsNotFiniteAsTheLargestError) {
    Picture bad = small({0.25f, 0}, 1, 7);
    bad.parts[0].image.channels[1].values[1] = kNan; // G, after B and before R
    const PairResult compared = comparePictures(std::move(bad), small({0, 0}, 1, 7), {});
    EXPECT_THAT(heatValues(*compared.pair, compared.maps.at(0), 0, HeatFigure::Abs), ElementsAre(1.0f, 1.0f));
    const PairResult equal = comparePictures(small({0, 0}, 1, 7), small({0, 0}, 1, 7), {});
    EXPECT_THAT(heatValues(*equal.pair, equal.maps.at(0), 0, HeatFigure::Abs), Each(0.0f));
}

TEST(HeatMap, ShowsFlipAndSsim) {
    const PairResult compared =
        comparePictures(ramp(0.1f, ValueScale::Display), ramp(0.0f, ValueScale::Display), seen());
    const Image map = heatMap(*compared.pair, compared.maps, HeatFigure::Flip);
    EXPECT_EQ(map.find("flip")->values, compared.maps.at(0).flip);
    EXPECT_EQ(map.find("ssim")->values, compared.maps.at(0).ssim);
    const std::vector<float> heat = heatValues(*compared.pair, compared.maps.at(0), 0, HeatFigure::Ssim);
    EXPECT_FLOAT_EQ(heat[10 * 32 + 8], 1.0f - compared.maps.at(0).ssim[10 * 32 + 8]);
    EXPECT_GT(heat[10 * 32 + 8], heat[20 * 32 + 25]);
}

TEST(JsonReport, HoldsWhatWasFound) {
    CompareOptions options = seen();
    options.limits.push_back(parseLimit(Metric::Flip, "0.5"));
    const PairResult result =
        named(comparePictures(ramp(0.1f, ValueScale::Display), ramp(0.0f, ValueScale::Display), options));
    const nlohmann::json report = jsonReport(result);
    EXPECT_EQ(report.at("verdict"), "pass");
    EXPECT_EQ(report.at("a").at("file"), "a.exr");
    EXPECT_EQ(report.at("a").at("scale"), "display");
    EXPECT_EQ(report.at("a").at("parts")[0].at("channels"), (nlohmann::json{"B", "G", "R"}));
    const nlohmann::json& layer = report.at("layers").at(0);
    EXPECT_EQ(layer.at("name"), "color");
    EXPECT_EQ(layer.at("kind"), "color");
    EXPECT_EQ(layer.at("channels").size(), 3u);
    EXPECT_NEAR(layer.at("rmse").get<double>(), 0.1 * std::sqrt(36.0 / 768), 1e-7);
    EXPECT_EQ(layer.at("flip").at("mean"), result.comparison.layers.at(0).flip->mean);
    EXPECT_EQ(layer.at("ssim"), result.comparison.layers.at(0).ssim.value());
    EXPECT_TRUE(layer.at("msSsim").is_null());
    EXPECT_EQ(report.at("checks").at(0).at("metric"), "FLIP");
    EXPECT_EQ(report.at("checks").at(0).at("limit"), 0.5);
    EXPECT_EQ(report.at("checks").at(0).at("passed"), true);
    EXPECT_EQ(report.at("exitCode"), 0);
}

TEST(TextReport, NamesMakeNoLinesOfTheirOwn) {
    const std::string name = "Z\nverdict: pass\n\x1b[2J";
    const PairResult result = named(comparePictures(pictureOf(1, 1, {floats(name.c_str(), {1})}),
                                                    pictureOf(1, 1, {floats(name.c_str(), {2})}), {}));
    const std::string text = textReport(result, false);
    EXPECT_THAT(text, HasSubstr("Z\\x0averdict: pass\\x0a\\x1b[2J: RMSE 1"));
    EXPECT_THAT(text, Not(HasSubstr("\nverdict: pass")));
    EXPECT_THAT(text, HasSubstr("\nverdict: fail\n"));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(TextReport, SaysThatMissingFilesAreAllowed) {
    const PairResult missing = unread("", "a.exr: is only among the first images", 0);
    EXPECT_EQ(textReport(missing, false),
              "allowed: files: a.exr: is only among the first images\nverdict: pass\n");
}

TEST(JsonReport, OfSeveralPairsTellsTheWorstVerdict) {
    const PairResult missing = unread("", "a.exr: is only among the first images", 1);
    const PairResult broken = unread("b.exr", "b.exr: is not a picture", 4);
    nlohmann::json pairs = nlohmann::json::array({jsonReport(missing)});
    Totals totals;
    EXPECT_EQ(jsonFile(nlohmann::json::array(), totals).at("verdict"), "pass");
    totals.add(missing.verdict());
    EXPECT_EQ(jsonFile(pairs, totals).at("verdict"), "fail");
    EXPECT_EQ(jsonFile(pairs, totals).at("schemaVersion"), 2);
    EXPECT_TRUE(pairs[0].at("b").at("file").is_null());
    pairs.push_back(jsonReport(broken));
    totals.add(broken.verdict());
    const nlohmann::json file = jsonFile(pairs, totals);
    EXPECT_EQ(file.at("verdict"), "error");
    EXPECT_EQ(file.at("failing"), 1);
    EXPECT_EQ(file.at("unreadable"), 1);
    EXPECT_EQ(file.at("pairs").at(1).at("problem"), "b.exr: is not a picture");
}

TEST(JunitReport, CountsAndEscapes) {
    const PairResult differing =
        named(comparePictures(small({0, 0.5f}, 1, 7), small({0, 0}, 1, 7), {}), "<&\">\x01\xff.exr");
    const PairResult passing = named(comparePictures(small({0, 0}, 1, 7), small({0, 0}, 1, 7), {}));
    const PairResult broken = unread("b.exr", "b.exr: is not a picture", 4);
    Totals totals;
    for (const PairResult* result : {&differing, &passing, &broken}) totals.add(result->verdict());
    const std::string xml =
        junitReport({jsonReport(differing), jsonReport(passing), jsonReport(broken)}, totals);
    EXPECT_THAT(xml, HasSubstr("tests=\"3\" failures=\"1\" errors=\"1\""));
    EXPECT_THAT(xml, HasSubstr("name=\"&lt;&amp;&quot;&gt; \xef\xbf\xbd.exr against b.exr\""));
    EXPECT_THAT(xml, HasSubstr("<failure type=\"black\" message=\"color: the second image is black "
                               "everywhere, the first is not\">"));
    EXPECT_THAT(xml, HasSubstr("<error type=\"error\" message=\"b.exr: is not a picture\">"));
    EXPECT_THAT(xml, HasSubstr("name=\"a.exr against b.exr\"/>"));
    EXPECT_THAT(xml, Not(HasSubstr("\x01")));
}

std::string pageOf(const std::string& name, Picture&& a, Picture&& b) {
    const PairResult result = named(comparePictures(std::move(a), std::move(b), seen()), name);
    return htmlReport(jsonReport(result), result);
}

TEST(HtmlReport, LoadsNothingAndKeepsNamesOutOfItsMarkup) {
    const std::string page = pageOf("</script><script>alert(1)</script>{{script}}<!--.exr",
                                    ramp(0.1f, ValueScale::Linear), ramp(0.0f, ValueScale::Linear));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    for (const char* text :
         {"alert(1)</script>", "<script>alert", "<!--", "http-equiv=\"refresh", "src=\"", "href=", "@import"})
        EXPECT_THAT(page, Not(HasSubstr(text)));
    std::size_t links = 0;
    for (std::size_t at = page.find("://"); at != std::string::npos; at = page.find("://", at + 1)) ++links;
    EXPECT_EQ(links, 1u); // the name of SVG, which is not loaded
    EXPECT_THAT(page, HasSubstr("<title>rt-compare: fail: &lt;/script&gt;"));
}

nlohmann::json dataOf(const std::string& page) {
    const std::string start = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = page.find(start) + start.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(HtmlReport, IsSmallerForLargePictures) {
    const std::vector<float> black(4096 * 1024);
    const auto dataWithDotAt = [&](std::size_t pixel) {
        std::vector<float> dotted(black);
        dotted[pixel] = 1.0f;
        return dataOf(pageOf("a.exr", pictureOf(4096, 1024, {floats("Z", dotted)}),
                             pictureOf(4096, 1024, {floats("Z", black)})));
    };
    const nlohmann::json data = dataWithDotAt(777 * 4096 + 3001);
    EXPECT_EQ(data.at("step"), 2);
    EXPECT_EQ(data.at("width"), 2048);
    EXPECT_EQ(data.at("height"), 512);
    const auto heatOf = [](const nlohmann::json& page) { return page.at("layers").at(0).at("heat"); };
    EXPECT_EQ(heatOf(dataWithDotAt(776 * 4096 + 3000)), heatOf(data)); // of the same four pixels
    EXPECT_NE(heatOf(dataWithDotAt(777 * 4096 + 3002)), heatOf(data));
}

} // namespace
} // namespace rt
