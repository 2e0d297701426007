#include "tools/rt-compare/metrics.h"

#include "formats/image_exr.h"
#include "tests/support/scenes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace rt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Type = ImageChannel::Type;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

ImageChannel floats(const char* name, std::vector<float> values) {
    return {name, Type::Float, std::move(values), {}};
}
ImageChannel uints(const char* name, std::vector<std::uint32_t> values) {
    return {name, Type::Uint, {}, std::move(values)};
}

Image imageOf(std::uint32_t width, std::uint32_t height, std::vector<ImageChannel> channels) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = std::move(channels);
    return image;
}

// 2x2 pixels, differences by hand: B 0 0 0 0, G 0.5 0 0 0, R 0 -1 0 2.
Image handA() {
    return imageOf(2, 2, {floats("B", {1, 2, 3, 4}), floats("G", {1, 1, 1, 1}), floats("R", {0, 1, 2, 3})});
}
Image handB() {
    return imageOf(2, 2,
                   {floats("B", {1, 2, 3, 4}), floats("G", {0.5f, 1, 1, 1}), floats("R", {0, 2, 2, 1})});
}

TEST(CompareMetrics, HandComputedRmseIsTheRootOfTheMeanSquareOverAllColorValues) {
    const Comparison c = compareImages(handA(), handB(), 0.0);
    ASSERT_TRUE(c.color);
    EXPECT_DOUBLE_EQ(c.color->rmse(), std::sqrt((0.25 + 1.0 + 4.0) / 12.0)); // not the MSE, not the MAE
    EXPECT_DOUBLE_EQ(c.color->maxAbs, 2.0);
    EXPECT_EQ(c.color->compared, 12u);
    ASSERT_EQ(c.channels.size(), 3u);
    EXPECT_DOUBLE_EQ(c.channels[0].sums.rmse(), 0.0);
    EXPECT_DOUBLE_EQ(c.channels[1].sums.rmse(), 0.25);
    EXPECT_DOUBLE_EQ(c.channels[1].sums.maxAbs, 0.5);
    EXPECT_DOUBLE_EQ(c.channels[2].sums.rmse(), std::sqrt(5.0 / 4.0));
}

TEST(CompareMetrics, WorstPixelIsShownWithPositionAndBothValues) {
    const Comparison c = compareImages(handA(), handB(), 0.0);
    ASSERT_TRUE(c.worst);
    EXPECT_EQ(c.worst->channel, "R");
    EXPECT_EQ(c.worst->x, 1u);
    EXPECT_EQ(c.worst->y, 1u);
    EXPECT_EQ(c.worst->a, 3.0);
    EXPECT_EQ(c.worst->b, 1.0);
    EXPECT_FALSE(compareImages(handA(), handA(), 0.0).worst);
}

TEST(CompareMetrics, VerdictFollowsTheLimitInclusively) {
    const double rmse = std::sqrt(5.25 / 12.0);
    EXPECT_TRUE(compareImages(handA(), handB(), rmse).passed());
    EXPECT_FALSE(compareImages(handA(), handB(), std::nextafter(rmse, 0.0)).passed());
    EXPECT_FALSE(compareImages(handA(), handB(), 0.0).passed());
    EXPECT_TRUE(compareImages(handA(), handA(), 0.0).passed());
}

TEST(CompareMetrics, SumsDoNotOverflowOrCancelWhereFloatsWould) {
    constexpr float kMax = std::numeric_limits<float>::max();
    const Comparison huge =
        compareImages(imageOf(1, 1, {floats("R", {kMax})}), imageOf(1, 1, {floats("R", {-kMax})}), 0.0);
    EXPECT_DOUBLE_EQ(huge.color->rmse(), 2.0 * double(kMax));
    const Comparison tiny =
        compareImages(imageOf(1, 1, {floats("R", {1e-30f})}), imageOf(1, 1, {floats("R", {0.0f})}), 0.0);
    EXPECT_DOUBLE_EQ(tiny.color->rmse(), double(1e-30f));
    EXPECT_FALSE(tiny.passed());
}

TEST(CompareMetrics, NonFiniteValuesNeverPassNotEvenInBothImages) {
    for (const float value : {kNan, kInf, -kInf}) {
        Image a = handA();
        a.channels[1].values[2] = value;
        EXPECT_FALSE(compareImages(a, handA(), 1e30).passed());
        EXPECT_FALSE(compareImages(handA(), a, 1e30).passed());
        EXPECT_FALSE(compareImages(a, a, 1e30).passed());
    }
}

TEST(CompareMetrics, NonFiniteValuesAreCountedOverAllChannelsAndLeftOutOfTheRmse) {
    Image a = handA();
    a.channels[1].values = {kNan, kInf, kInf, 1.0f};
    a.channels.push_back(floats("Z", {1.0f, kNan, -kInf, 1.0f}));
    Image b = handB();
    b.channels.push_back(floats("Z", {1.0f, 1.0f, 1.0f, 1.0f}));
    const Comparison c = compareImages(a, b, 1e30);
    EXPECT_EQ(c.nonFiniteA.nan, 2u);
    EXPECT_EQ(c.nonFiniteA.positiveInf, 2u);
    EXPECT_EQ(c.nonFiniteA.negativeInf, 1u);
    EXPECT_EQ(c.nonFiniteA.pixels, 3u); // the second has one in G and one in Z
    EXPECT_EQ(c.nonFiniteA.first->channel, "G");
    EXPECT_EQ(c.nonFiniteB.total(), 0u);
    EXPECT_EQ(c.nonFiniteB.pixels, 0u);
    EXPECT_EQ(c.color->compared, 9u);
    EXPECT_EQ(c.color->values, 12u);
    EXPECT_DOUBLE_EQ(c.color->rmse(), std::sqrt(5.0 / 9.0));
    EXPECT_THAT(
        c.failures,
        ElementsAre(HasSubstr("5 non-finite values in 3 pixels of the first image, first in G at x 0, y 0")));
}

TEST(CompareMetrics, ImagesWithoutAFinitePairFail) {
    const Image nan = imageOf(1, 1, {floats("R", {kNan})});
    const Comparison c = compareImages(nan, nan, 1e30);
    EXPECT_TRUE(std::isnan(c.color->rmse()));
    EXPECT_FALSE(c.passed());
}

TEST(CompareMetrics, OtherSizesFailWithoutMetrics) {
    const Image wide = imageOf(4, 1, {floats("R", {0, 0, 0, 0})});
    const Image square = imageOf(2, 2, {floats("R", {0, 0, 0, 0})});
    const Comparison c = compareImages(wide, square, 1e30);
    EXPECT_THAT(c.failures, ElementsAre("sizes differ: 4 x 1 against 2 x 2"));
    EXPECT_FALSE(c.color);
}

TEST(CompareMetrics, RenamedExtraAndRetypedChannelsFail) {
    const Image a = imageOf(1, 1, {floats("R", {0}), floats("Z", {0}), uints("id", {1})});
    Image renamed = a;
    renamed.channels[1].name = "depth";
    EXPECT_THAT(
        compareImages(a, renamed, 1e30).failures,
        ElementsAre("channel Z is in the first image only", "channel depth is in the second image only"));
    Image extra = a;
    extra.channels.push_back(floats("zero", {0}));
    EXPECT_THAT(compareImages(a, extra, 1e30).failures,
                ElementsAre("channel zero is in the second image only"));
    Image retyped = a;
    retyped.channels[2] = floats("id", {1});
    EXPECT_THAT(compareImages(a, retyped, 1e30).failures, ElementsAre("channel id is uint against number"));
}

TEST(CompareMetrics, HalfAgainstFloatIsComparedByValue) {
    Image half = handA();
    for (ImageChannel& channel : half.channels) channel.type = Type::Half;
    EXPECT_TRUE(compareImages(half, handA(), 0.0).passed());
}

TEST(CompareMetrics, WithoutAColorChannelInCommonNothingPasses) {
    const Image depth = imageOf(1, 1, {floats("Z", {0})});
    EXPECT_THAT(compareImages(depth, depth, 1e30).failures, ElementsAre(HasSubstr("no color channel")));
}

TEST(CompareMetrics, UintChannelsAreCountedByPixel) {
    const Image a = imageOf(2, 2, {floats("R", {0, 0, 0, 0}), uints("id", {1, 2, 0xFFFFFFFFu, 16777216u})});
    const Image b = imageOf(2, 2, {floats("R", {0, 0, 0, 0}), uints("id", {1, 3, 0xFFFFFFFFu, 16777217u})});
    const Comparison c = compareImages(a, b, 0.0);
    ASSERT_EQ(c.uints.size(), 1u);
    EXPECT_EQ(c.uints[0].pixels, 2u);
    EXPECT_TRUE(c.passed());
}

TEST(CompareMetrics, AgreesWithReferenceValuesOfRealRenders) {
    // Computed over R, G and B by another program.
    const struct {
        const char *a, *b;
        double rmse, maxAbs;
    } pairs[] = {
        {"oriented_bspline_curve_twisted.ecs.embree_pathtracer.exr",
         "oriented_hermite_curve_twisted.ecs.embree_pathtracer.exr", 0.00667387973, 0.937254965},
        {"mblur_time_range_grid.ecs.embree_viewer.exr", "mblur_time_range_quad.ecs.embree_viewer.exr", 0.0,
         0.0},
        {"hair0.ecs.embree_viewer.exr", "hair0.ecs.embree_viewer_grid.exr", 0.260161247, 0.909803987}};
    if (!std::filesystem::is_directory(test::scenePath("images/pairs"))) GTEST_SKIP() << "no scenes";
    for (const auto& pair : pairs) {
        const Comparison c =
            compareImages(readExr(test::scenePath(std::string("images/pairs/") + pair.a)),
                          readExr(test::scenePath(std::string("images/pairs/") + pair.b)), 0.0);
        EXPECT_NEAR(c.color->rmse(), pair.rmse, 1e-9);
        EXPECT_NEAR(c.color->maxAbs, pair.maxAbs, 1e-9);
        EXPECT_EQ(c.passed(), pair.rmse == 0.0);
    }
}

} // namespace
} // namespace rt
