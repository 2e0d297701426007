#include "common/error.h"
#include "tests/support/compared_layers.h"
#include "tests/support/split_mix.h"
#include "tests/support/test_pictures.h"
#include "tools/rt-compare/compare.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rt::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// "kind: text" of all findings that fail.
std::vector<std::string> failures(const Comparison& comparison) {
    std::vector<std::string> texts;
    for (const Finding& finding : comparison.findings)
        if (finding.fails) texts.push_back(finding.kind + ": " + finding.text);
    EXPECT_EQ(texts.empty(), comparison.passed());
    return texts;
}

Comparison compare(const Picture& a, const Picture& b, const CompareOptions& options = {}) {
    return comparePictures(Picture(a), Picture(b), options).comparison;
}
std::vector<std::string> failuresOf(const Picture& a, const Picture& b, const CompareOptions& options = {}) {
    return failures(compare(a, b, options));
}

CompareOptions allowing(const std::string& kind) {
    CompareOptions options;
    options.allowed.insert(kind);
    return options;
}

/// Limits so loose that only what is no matter of degree fails.
CompareOptions loose() {
    CompareOptions options;
    options.limits.push_back({Metric::Rmse, "*", 0.0, 1e30});
    options.limits.push_back({Metric::Differing, "*", 0.0, 1.0});
    return options;
}

/// 20x10 pixels of colors, depth and ids.
Image render() {
    Image image = imageOf(20, 10,
                          {floats("B", std::vector<float>(200)), floats("G", std::vector<float>(200)),
                           floats("R", std::vector<float>(200)), floats("Z", std::vector<float>(200)),
                           uints("id", std::vector<std::uint32_t>(200))});
    for (std::size_t i = 0; i < 200; ++i) {
        const float v = 0.5f + 0.5f * std::sin(static_cast<float>(i * i % 97));
        image.channels[0].values[i] = v;
        image.channels[1].values[i] = 0.5f * v;
        image.channels[2].values[i] = 1.0f - v;
        image.channels[3].values[i] = 10.0f + v;
        image.channels[4].uints[i] = static_cast<std::uint32_t>(i / 7);
    }
    image.ints["samplesPerPixel"] = 16;
    image.matrices["worldToCamera"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    return image;
}
Picture picture() {
    return pictureOf(render());
}
Picture withValue(std::size_t channel, std::size_t pixel, float value) {
    Image image = render();
    image.channels[channel].values[pixel] = value;
    return pictureOf(image);
}

// What the usual tools pass (idiff, oiiotool, FLIP), one test for each.

TEST(FalsePass, OneNaNPixel) {
    EXPECT_THAT(
        failuresOf(withValue(1, 33, kNan), picture(), loose()),
        ElementsAre(HasSubstr("non-finite: 1 non-finite values in 1 pixels of the first image, first in G at "
                              "x 13, y 1")));
    EXPECT_THAT(failuresOf(picture(), withValue(1, 33, kNan), loose()),
                ElementsAre(HasSubstr("of the second image")));
}

TEST(FalsePass, TwoPerCentOfNaN) {
    Image image = render();
    for (std::size_t i = 0; i < 200; i += 50) image.channels[2].values[i] = kNan;
    EXPECT_THAT(failuresOf(pictureOf(image), picture(), loose()),
                ElementsAre(HasSubstr("4 non-finite values")));
}

TEST(FalsePass, NothingButNaN) {
    Image image = render();
    for (std::size_t c = 0; c < 3; ++c) image.channels[c].values.assign(200, kNan);
    EXPECT_THAT(failuresOf(pictureOf(image), picture(), loose()),
                Contains(HasSubstr("600 non-finite values in 200")));
    EXPECT_THAT(failuresOf(pictureOf(image), pictureOf(image), loose()), Contains(HasSubstr("non-finite")));
}

TEST(FalsePass, OppositeInfinities) {
    EXPECT_THAT(failuresOf(withValue(0, 5, kInf), withValue(0, 5, -kInf), loose()),
                Contains(HasSubstr("1 +Inf")));
    CompareOptions options = loose();
    options.allowSameNonFinite = true;
    EXPECT_THAT(failuresOf(withValue(0, 5, kInf), withValue(0, 5, -kInf), options),
                Contains("non-finite: 1 of them are not the same in both images"));
}

TEST(FalsePass, RenamedChannel) {
    Image renamed = render();
    renamed.channels[3].name = "depth";
    EXPECT_THAT(failuresOf(picture(), pictureOf(renamed), loose()),
                ElementsAre("channels: channel Z is called depth in the second image"));
}

TEST(FalsePass, ExtraChannelOfZeros) {
    Image extra = render();
    extra.channels.push_back(floats("zero", std::vector<float>(200)));
    EXPECT_THAT(failuresOf(picture(), pictureOf(extra), loose()),
                ElementsAre("channels: channel zero is in the second image only"));
    EXPECT_THAT(failuresOf(pictureOf(extra), picture(), loose()),
                ElementsAre("channels: channel zero is in the first image only"));
}

TEST(FalsePass, PartsAfterTheFirst) {
    Picture two = picture();
    two.parts.push_back(two.parts.front());
    two.parts[0].name = "left";
    two.parts[1].name = "right";
    EXPECT_THAT(failuresOf(two, two), IsEmpty());
    Picture other = two;
    other.parts[1].image.channels[2].values[7] += 0.25f;
    const Comparison c = compare(two, other);
    EXPECT_THAT(failures(c), ElementsAre(HasSubstr("limit: right/color: RMSE")));
    EXPECT_EQ(c.layers[3].name, "right/color");
    EXPECT_EQ(c.layers[3].worst[0].channel, "right/R");
    other = two;
    other.parts[1].image.channels[3].values[7] = kNan;
    EXPECT_THAT(failuresOf(two, other, loose()), Contains(HasSubstr("non-finite")));
    EXPECT_THAT(failuresOf(two, picture(), loose()), Contains("parts: numbers of parts differ: 2 against 1"));
}

TEST(FalsePass, BlackFrameWithinALooseLimit) {
    Image dim = imageOf(4, 1, {floats("R", {0, 0, 0, 0.01f})}),
          black = imageOf(4, 1, {floats("R", {0, 0, 0, 0})});
    EXPECT_THAT(failuresOf(pictureOf(black), pictureOf(dim), loose()),
                ElementsAre("black: color: the first image is black everywhere, the second is not"));
    EXPECT_THAT(failuresOf(pictureOf(dim), pictureOf(black), loose()),
                ElementsAre(HasSubstr("the second image is black")));
    EXPECT_THAT(failuresOf(pictureOf(black), pictureOf(black), loose()), IsEmpty());
    CompareOptions options = loose();
    options.allowed.insert("black");
    EXPECT_THAT(failuresOf(pictureOf(black), pictureOf(dim), options), IsEmpty());
}

TEST(FalsePass, OtherCamera) {
    Image moved = render();
    moved.matrices["worldToCamera"][3] = 0.5f;
    EXPECT_THAT(failuresOf(picture(), pictureOf(moved), loose()),
                ElementsAre(HasSubstr(
                    "camera: camera matrix worldToCamera differs, first in row 0, column 3: 0 against 0.5")));
    moved.matrices.clear();
    EXPECT_THAT(failuresOf(picture(), pictureOf(moved), loose()),
                ElementsAre(HasSubstr("only the first image has")));
    EXPECT_THAT(failuresOf(picture(), pictureOf(moved), allowing("camera")), IsEmpty());
}

TEST(FalsePass, DepthAndIdsThatNobodyLookedAt) {
    EXPECT_THAT(failuresOf(picture(), withValue(3, 60, 11.5f)), ElementsAre(HasSubstr("limit: Z: RMSE")));
    Image image = render();
    image.channels[4].uints[0] = 99;
    EXPECT_THAT(failuresOf(picture(), pictureOf(image)),
                ElementsAre("limit: id: fraction of pixels that differ 0.005 exceeds 0"));
}

// Verdicts.

TEST(ComparePictures, EqualPicturesPass) {
    EXPECT_THAT(failuresOf(picture(), picture()), IsEmpty());
    EXPECT_TRUE(compare(picture(), picture()).notes.empty());
}

TEST(ComparePictures, NonFiniteValuesMayBeAllowedWhereTheyAreTheSame) {
    CompareOptions options;
    options.allowSameNonFinite = true;
    for (const float value : {kNan, kInf, -kInf}) {
        EXPECT_THAT(failuresOf(withValue(1, 3, value), withValue(1, 3, value), options), IsEmpty());
        EXPECT_THAT(failuresOf(withValue(1, 3, value), withValue(1, 3, value)),
                    Contains(HasSubstr("non-finite")));
        EXPECT_THAT(failuresOf(withValue(1, 3, value), withValue(1, 4, value), options),
                    Contains(HasSubstr("non-finite")));
        EXPECT_THAT(failuresOf(withValue(1, 3, value), withValue(0, 3, value), options),
                    Contains(HasSubstr("non-finite")));
        EXPECT_THAT(failuresOf(withValue(1, 3, value), picture(), options),
                    Contains(HasSubstr("non-finite")));
    }
}

TEST(ComparePictures, NonFiniteValuesAreCountedByKindAndPlace) {
    Image a = render();
    a.channels[1].values[0] = kNan;
    a.channels[1].values[1] = a.channels[1].values[2] = kInf;
    a.channels[3].values[1] = kNan;
    a.channels[3].values[2] = -kInf;
    const Comparison c = compare(pictureOf(a), picture(), loose());
    EXPECT_EQ(c.nonFiniteA.nan, 2u);
    EXPECT_EQ(c.nonFiniteA.positiveInf, 2u);
    EXPECT_EQ(c.nonFiniteA.negativeInf, 1u);
    EXPECT_EQ(c.nonFiniteA.pixels, 3u);
    EXPECT_EQ(c.nonFiniteA.first->channel, "G");
    EXPECT_EQ(c.nonFiniteB.total(), 0u);
    EXPECT_EQ(c.nonFiniteDiffering, 5u);
    ASSERT_EQ(c.nonFinitePlaces.size(), 5u);
    EXPECT_EQ(c.nonFinitePlaces[4].channel, "Z");
    EXPECT_EQ(c.nonFinitePlaces[4].x, 2);
    EXPECT_EQ(c.nonFinitePlaces[4].a, -double(kInf));
    EXPECT_EQ(colorOf(c)->figures.compared, 597u);
    EXPECT_EQ(colorOf(c)->figures.values, 600u);
}

TEST(ComparePictures, LimitsHoldInclusively) {
    const Picture other = withValue(2, 7, 3.0f);
    const double rmse = colorOf(compare(picture(), other))->figures.rmse;
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0.0, rmse}};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.limits[0].value = std::nextafter(rmse, 0.0);
    EXPECT_THAT(failuresOf(picture(), other, options), ElementsAre(HasSubstr("limit: color: RMSE")));
}

TEST(ComparePictures, EveryFigureMayHaveALimit) {
    const Picture other = withValue(2, 7, 3.0f);
    const ErrorFigures f = colorOf(compare(picture(), other))->figures;
    const Limit limits[] = {{Metric::MaxAbs, "", 0, f.maxAbs},    {Metric::Mae, "", 0, f.mae},
                            {Metric::Mse, "", 0, f.mse},          {Metric::RelMse, "", 0, f.relMse},
                            {Metric::Smape, "", 0, f.smape},      {Metric::Percentile, "", 99.9, f.maxAbs},
                            {Metric::Over, "", 0.1, 1.0 / 200.0}, {Metric::Differing, "", 0, 1.0 / 200.0}};
    for (Limit limit : limits) {
        CompareOptions options;
        options.limits = {limit};
        EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty()) << metricName(limit);
        options.limits[0].value *= 0.999;
        EXPECT_THAT(failuresOf(picture(), other, options), ElementsAre(HasSubstr(metricName(limit))))
            << metricName(limit);
    }
    CompareOptions options;
    options.limits = {{Metric::Psnr, "", 0, f.psnr}};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.limits[0].value += 0.001;
    EXPECT_THAT(failuresOf(picture(), other, options), ElementsAre(HasSubstr("is below")));
}

TEST(ComparePictures, TheMostPreciseNameOfALimitCounts) {
    Image image = render();
    image.channels[3].values[0] += 1.0f; // Z
    image.channels[0].values[0] += 1.0f; // B
    const Picture other = pictureOf(image);
    const auto run = [&](std::vector<Limit> limits) {
        CompareOptions options;
        options.limits = std::move(limits);
        return failuresOf(picture(), other, options);
    };
    EXPECT_THAT(run({{Metric::Rmse, "Z", 0, 1}}),
                ElementsAre(HasSubstr("color: RMSE")));      // colors must be equal
    EXPECT_THAT(run({{Metric::Rmse, "", 0, 1}}), IsEmpty()); // Z is free
    EXPECT_THAT(run({{Metric::Rmse, "*", 0, 1}}), IsEmpty());
    EXPECT_THAT(run({{Metric::Rmse, "*", 0, 0}, {Metric::Rmse, "color", 0, 1}}),
                ElementsAre(HasSubstr("Z: RMSE")));
    EXPECT_THAT(run({{Metric::Rmse, "Z", 0, 0}, {Metric::Rmse, "*", 0, 1}}),
                ElementsAre(HasSubstr("Z: RMSE")));
    EXPECT_THAT(run({{Metric::Rmse, "", 0, 1}, {Metric::MaxAbs, "B", 0, 0.5}}),
                ElementsAre(HasSubstr("B: maximum |a-b|")));
    EXPECT_THAT(run({{Metric::Rmse, "", 0, 1}, {Metric::Rmse, "depth", 0, 1}}),
                ElementsAre(HasSubstr("no layer or channel is called depth")));
}

TEST(ComparePictures, LayersThatDifferWithoutALimitAreNoted) {
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}};
    const Comparison c = compare(picture(), withValue(3, 0, 0.0f), options);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, ElementsAre(HasSubstr("no limit holds Z, which differ")));
}

TEST(ComparePictures, WhatTheCameraIsMustBeTheSame) {
    for (const char* name : {"screenWindowWidth", "screenWindowCenter", "view", "envmap"}) {
        Picture other = picture();
        other.parts[0].camera[name] = std::string("2");
        EXPECT_THAT(failuresOf(other, picture()),
                    ElementsAre(HasSubstr(fmt::format("{} differs: 2 against", name))));
        EXPECT_THAT(failuresOf(other, picture(), allowing("camera")), IsEmpty());
    }
}

TEST(ComparePictures, IdsMustBeEqualUnlessALimitNamesThem) {
    const auto withIds = [](std::uint32_t id) {
        return pictureOf(imageOf(1, 1, {floats("Y", {1}), uints("id", {id})}));
    };
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}};
    EXPECT_THAT(failuresOf(withIds(7), withIds(8), options),
                ElementsAre(HasSubstr("id: fraction of pixels that differ 1 exceeds 0")));
    EXPECT_THAT(failuresOf(withIds(7), withIds(7), options), IsEmpty());
    options.limits.push_back({Metric::Differing, "id", 0, 1});
    EXPECT_THAT(failuresOf(withIds(7), withIds(8), options), IsEmpty());
}

TEST(ComparePictures, LayersWhoseChannelsAreCalledOtherwiseMustNotBeBlackEither) {
    const auto withBeauty = [](float value) {
        return pictureOf(imageOf(
            1, 1, {floats("B", {1}), floats("G", {1}), floats("R", {1}), floats("beauty.r", {value})}));
    };
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}};
    EXPECT_THAT(failuresOf(withBeauty(0), withBeauty(1), options),
                ElementsAre(HasSubstr("the first image is 0 everywhere, the second is not")));
    EXPECT_THAT(failuresOf(withBeauty(2), withBeauty(1), options), IsEmpty());
}

TEST(ComparePictures, NamesOfChannelsThatNoPictureHasAreNotTakenInSilence) {
    CompareOptions options;
    options.focus.onlyChannels = {"color", "difuse"};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("no channel or layer is called difuse, which --channels names")));
    options.focus.onlyChannels = {"color"};
    options.focus.withoutChannels = {"X"};
    const Comparison c = compare(picture(), picture(), options);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, Contains(HasSubstr("called X, which --ignore-channels names")));
}

TEST(ComparePictures, ALimitThatHoldsNothingIsNoPass) {
    const Picture depth = pictureOf(imageOf(1, 1, {floats("Z", {1})}));
    EXPECT_THAT(failuresOf(depth, depth), IsEmpty()); // equal
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1e30}}; // of colors
    EXPECT_THAT(failuresOf(depth, depth, options),
                ElementsAre(HasSubstr("nothing: no limit holds any layer")));
    const Picture other = pictureOf(imageOf(1, 1, {floats("Y", {1})}));
    EXPECT_THAT(failuresOf(depth, other, allowing("channels")),
                ElementsAre(HasSubstr("no channel in common")));
}

TEST(ComparePictures, SizesThatDifferFailWithoutFigures) {
    const Picture wide = pictureOf(imageOf(4, 1, {floats("R", {1, 1, 1, 1})}));
    const Picture square = pictureOf(imageOf(2, 2, {floats("R", {1, 1, 1, 1})}));
    const Comparison c = compare(wide, square, loose());
    EXPECT_THAT(failures(c), ElementsAre("size: sizes differ: 4 x 1 against 2 x 2"));
    EXPECT_EQ(colorOf(c), nullptr);
    EXPECT_THAT(failuresOf(wide, square, allowing("size")), ElementsAre(HasSubstr("limit: color: RMSE")));
}

TEST(ComparePictures, DataWindowsThatDifferFailAndCountAsZeroOutsideIfAllowed) {
    Picture whole = pictureOf(imageOf(4, 1, {floats("R", {0, 1, 2, 0})}));
    Picture part = pictureOf(imageOf(2, 1, {floats("R", {1, 2})}));
    part.parts[0].displayWindow = {0, 0, 4, 1};
    part.parts[0].dataWindow = {1, 0, 3, 1};
    EXPECT_THAT(failuresOf(whole, part, loose()),
                ElementsAre("data-window: data windows differ: 0,0,4,1 against 1,0,3,1"));
    EXPECT_THAT(failuresOf(whole, part, allowing("data-window")), IsEmpty());
    part.parts[0].image.channels[0].values[1] = 2.5f;
    const Comparison c = compare(whole, part, allowing("data-window"));
    EXPECT_EQ(colorOf(c)->worst[0].x, 2);
    EXPECT_EQ(colorOf(c)->figures.values, 4u);
    whole.parts[0].image.channels[0].values[3] = 9.0f; // outside of the part
    EXPECT_EQ(colorOf(compare(whole, part, allowing("data-window")))->figures.maxAbs, 9.0);
    Picture far = part;
    far.parts[0].dataWindow = {1 << 20, 1 << 20, (1 << 20) + 2, (1 << 20) + 1};
    EXPECT_THROW(compare(whole, far, allowing("data-window")), Error);
    CompareOptions crop = allowing("data-window");
    crop.focus.crop = PixelBox{0, 0, 2, 1};
    EXPECT_THAT(failuresOf(whole, part, crop), IsEmpty());
}

TEST(ComparePictures, OtherMetadataFailsByName) {
    Picture other = picture();
    other.parts[0].pixelAspect = 2.0f;
    EXPECT_THAT(failuresOf(picture(), other, loose()),
                ElementsAre("pixel-aspect: pixel aspects differ: 1 against 2"));
    EXPECT_THAT(failuresOf(picture(), other, allowing("pixel-aspect")), IsEmpty());
    other = picture();
    other.parts[0].chromaticities = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    EXPECT_THAT(failuresOf(picture(), other, loose()), IsEmpty()) << "these are meant where none are given";
    Picture wide = other;
    (*wide.parts[0].chromaticities)[0] = 0.708f;
    EXPECT_THAT(failuresOf(wide, other, loose()),
                ElementsAre(HasSubstr("chromaticities: chromaticities differ: 0.708")));
    EXPECT_THAT(failuresOf(wide, other, allowing("chromaticities")), IsEmpty());
    other = picture();
    other.parts[0].image.ints["samplesPerPixel"] = 64;
    const Comparison c = compare(picture(), other);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, ElementsAre("samples per pixel: 16 against 64"));
}

TEST(ComparePictures, ChannelsOfOtherKindsFail) {
    Image retyped = render();
    retyped.channels[4] = floats("id", std::vector<float>(200));
    EXPECT_THAT(failuresOf(picture(), pictureOf(retyped), loose()),
                ElementsAre("channels: channel id is uint against number"));
    Image half = render();
    for (std::size_t c = 0; c < 4; ++c) half.channels[c].type = ImageChannel::Type::Half;
    EXPECT_THAT(failuresOf(picture(), pictureOf(half)), IsEmpty()) << "values count, not how they are stored";
}

TEST(ComparePictures, LinearLightAgainstDisplayValuesFailsUnlessItIsDecoded) {
    Picture linear = pictureOf(imageOf(2, 1, {floats("A", {0.5f, 1}), floats("R", {0.21404114f, 1})}));
    Picture display = pictureOf(imageOf(2, 1, {floats("A", {0.5f, 1}), floats("R", {0.5f, 1})}));
    display.scale = ValueScale::Display;
    display.format = "PNG, 8 bits";
    EXPECT_THAT(
        failuresOf(linear, display, loose()),
        ElementsAre("encoding: encodings differ: EXR holds linear light, PNG, 8 bits display values"));
    CompareOptions options = allowing("encoding");
    options.limits = {{Metric::MaxAbs, "", 0, 1e-6}};
    EXPECT_THAT(failuresOf(linear, display, options), IsEmpty());
}

TEST(ComparePictures, PartsAreMatchedByName) {
    Picture a = picture(), b;
    a.parts.push_back(partOf(imageOf(1, 1, {floats("Z", {5})})));
    a.parts[0].name = "beauty";
    a.parts[1].name = "depth";
    b = a;
    std::swap(b.parts[0], b.parts[1]);
    EXPECT_THAT(failuresOf(a, b), IsEmpty());
    b.parts[0].name = "other";
    EXPECT_THAT(failuresOf(a, b, loose()), ElementsAre("parts: part depth is in the first image only",
                                                       "parts: part other is in the second image only"));
}

TEST(ComparePictures, LayersAreGroupedByTheirNames) {
    const Image image = imageOf(1, 1,
                                {floats("A", {1}), floats("B", {1}), floats("G", {1}), floats("N.X", {1}),
                                 floats("N.Y", {1}), floats("N.Z", {1}), floats("R", {1}), floats("Z", {1}),
                                 floats("albedo.B", {1}), floats("albedo.G", {1}), floats("albedo.R", {1}),
                                 floats("albedo.Z", {1}), uints("id", {1})});
    std::vector<std::string> names;
    for (const LayerComparison& layer : compare(pictureOf(image), pictureOf(image)).layers) {
        names.push_back(layer.name + ":");
        for (const ChannelComparison& channel : layer.channels) names.back() += " " + channel.name;
    }
    EXPECT_THAT(names, ElementsAre("color: R G B A", "albedo: albedo.R albedo.G albedo.B", "N: N.X N.Y N.Z",
                                   "Z: Z", "albedo.Z: albedo.Z", "id: id"));
}

// Focus.

TEST(CompareFocus, CropsIgnoredRectanglesAndMasksHideWhatTheyShould) {
    const Picture other = withValue(2, 3 * 20 + 7, kNan); // x 7, y 3
    CompareOptions options;
    options.focus.crop = PixelBox{0, 0, 7, 10};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.focus.crop = PixelBox{7, 3, 8, 4};
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("first in R at x 7, y 3")));
    options.focus.crop.reset();
    options.focus.ignored = {{7, 3, 8, 4}};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    EXPECT_EQ(compare(picture(), other, options).ignored, 1u);
    options.focus.ignored = {{0, 0, 7, 10}, {8, 0, 20, 10}};
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("non-finite")));
    Picture mask = pictureOf(imageOf(20, 10, {floats("Y", std::vector<float>(200, 1.0f))}));
    options.focus.ignored.clear();
    options.focus.mask = &mask;
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("non-finite")));
    mask.parts[0].image.channels[0].values[3 * 20 + 7] = 0.0f;
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.focus.crop = PixelBox{5, 2, 15, 8}; // the mask stays where it is
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
}

TEST(CompareFocus, NothingLeftIsNoPass) {
    CompareOptions options;
    options.focus.crop = PixelBox{100, 100, 110, 110};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("nothing: no pixel is left")));
    options.focus.crop.reset();
    options.focus.ignored = {{-5, -5, 50, 50}};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("nothing: no pixel is left")));
}

TEST(CompareFocus, MasksThatDoNotFitAreRefused) {
    CompareOptions options;
    const Picture small = pictureOf(imageOf(1, 1, {floats("Y", {1})}));
    options.focus.mask = &small;
    EXPECT_THROW(compare(picture(), picture(), options), Error);
    const Picture broken = pictureOf(imageOf(20, 10, {floats("Y", std::vector<float>(200, kNan))}));
    options.focus.mask = &broken;
    EXPECT_THROW(compare(picture(), picture(), options), Error);
}

TEST(CompareFocus, ChannelsMayBeChosenOrLeftOut) {
    const Picture other = withValue(3, 0, kNan);
    CompareOptions options;
    options.focus.onlyChannels = {"color", "id"};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.focus.onlyChannels.clear();
    options.focus.withoutChannels = {"Z"};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.focus.withoutChannels = {"id"};
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("non-finite")));
}

TEST(CompareAlignment, FindsTheShiftOfMovedPictures) {
    const auto shifted = [](int dx, int dy) {
        Image image = imageOf(64, 48, {floats("G", std::vector<float>(64 * 48))});
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x) {
                const int u = x - dx, v = y - dy;
                image.channels[0].values[static_cast<std::size_t>(y * 64 + x)] =
                    std::sin(0.3f * static_cast<float>(u)) *
                    std::cos(0.17f * static_cast<float>(v) + 0.01f * static_cast<float>(u * v));
            }
        return pictureOf(image);
    };
    for (const auto& [dx, dy] : {std::pair(1, 0), {0, -1}, {3, 5}, {-7, 2}}) {
        const Comparison c = compare(shifted(0, 0), shifted(dx, dy));
        ASSERT_TRUE(c.alignment);
        EXPECT_EQ(c.alignment->dx, dx);
        EXPECT_EQ(c.alignment->dy, dy);
        EXPECT_LT(c.alignment->rmse, 1e-6);
        EXPECT_GT(c.alignment->rmseInPlace, 0.01);
    }
    EXPECT_FALSE(compare(shifted(0, 0), shifted(0, 0)).alignment);
    Picture brighter = shifted(0, 0);
    for (float& value : brighter.parts[0].image.channels[0].values) value *= 1.1f;
    EXPECT_FALSE(compare(shifted(0, 0), brighter).alignment->shifted());
    Picture noise = shifted(0, 0), otherNoise = noise;
    RayNumbers numbers(1, 1);
    for (Picture* p : {&noise, &otherNoise})
        for (float& value : p->parts[0].image.channels[0].values) value = numbers.unit();
    EXPECT_FALSE(compare(noise, otherNoise).alignment->shifted());
    CompareOptions options;
    options.maxShift = 0;
    EXPECT_FALSE(compare(shifted(0, 0), shifted(1, 0), options).alignment);
}

} // namespace
} // namespace rt::test
