#include "tests/support/compared_renders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rt::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

TEST(ComparePictures, APercentileOfLessThanOneValueHoldsNothing) {
    CompareOptions options;
    for (const double percent : {1e-300, 0.16, 0.17}) { // of 600 values
        options.metrics.percents.assign(1, percent);
        options.limits = {{Metric::Percentile, "", percent, 0}};
        const std::vector<std::string> found = failuresOf(picture(), withValue(2, 7, 3.0f), options);
        if (percent == 0.17) {
            EXPECT_THAT(found, IsEmpty());
        } else {
            EXPECT_THAT(found, ElementsAre(HasSubstr("could not be computed")));
        }
    }
    const auto grey = [](float value) { return pictureOf(imageOf(1, 1, {floats("Y", {value})})); };
    options.metrics.percents.assign(1, 50);
    options.limits = {{Metric::Percentile, "", 50, 0}};
    EXPECT_THAT(failuresOf(grey(1), grey(1), options), IsEmpty());
    EXPECT_THAT(failuresOf(grey(1), grey(2), options), ElementsAre(HasSubstr("exceeds 0")));
}

TEST(ComparePictures, OfLimitsWithTheSameNameTheStrictestCounts) {
    const Picture other = withValue(2, 7, 3.0f);
    const ErrorFigures f = colorOf(compare(picture(), other))->figures;
    for (const std::string name : {"", "*", "color", "R"})
        for (const Limit& loose :
             {Limit{Metric::Rmse, name, 0, 5}, Limit{Metric::MaxAbs, name, 0, 5},
              Limit{Metric::Percentile, name, 100, 5}, Limit{Metric::Psnr, name, 0, -50}})
            for (const bool isFirst : {true, false}) {
                Limit strict = loose;
                strict.value = loose.metric == Metric::Psnr ? f.psnr + 20 : 1e-3;
                CompareOptions options;
                options.limits = {loose, {Metric::Rmse, "", 0, 5}};
                options.metrics.percents.push_back(100);
                EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty()) << name;
                options.limits.insert(options.limits.begin() + (isFirst ? 0 : 1), strict);
                EXPECT_THAT(failuresOf(picture(), other, options), ElementsAre(HasSubstr(metricName(strict))))
                    << name;
            }
}

TEST(ComparePictures, ALimitOnAChannelLeavesTheOthersOfItsLayerEqual) {
    CompareOptions options;
    options.limits = {{Metric::Rmse, "R", 0, 5}};
    EXPECT_THAT(failuresOf(picture(), withValue(2, 7, 3.0f), options), IsEmpty()); // R
    EXPECT_THAT(failuresOf(picture(), withValue(1, 7, 3.0f), options),
                ElementsAre(HasSubstr("limit: G: RMSE")));
    options.limits.push_back({Metric::MaxAbs, "G", 0, 5});
    EXPECT_THAT(failuresOf(picture(), withValue(1, 7, 3.0f), options), IsEmpty());
    EXPECT_THAT(failuresOf(picture(), withValue(0, 7, 3.0f), options),
                ElementsAre(HasSubstr("limit: B: RMSE")));
    options.limits.push_back({Metric::Rmse, "color", 0, 5});
    EXPECT_THAT(failuresOf(picture(), withValue(0, 7, 3.0f), options), IsEmpty());
    const auto normals = [](float y) {
        return pictureOf(imageOf(1, 1, {floats("N.X", {1}), floats("N.Y", {y})}));
    };
    options.limits = {{Metric::Rmse, "N.X", 0, 5}};
    EXPECT_THAT(failuresOf(normals(1), normals(2), options), ElementsAre(HasSubstr("limit: N.Y: RMSE")));
}

TEST(ComparePictures, LimitsOnWhatIsSeenLeaveTheOpacityEqual) {
    const auto grey = [](float opacity) {
        const std::size_t count = 12 * 12;
        return pictureOf(imageOf(
            12, 12,
            {floats("A", std::vector<float>(count, opacity)), floats("Y", std::vector<float>(count, 0.5f))}));
    };
    CompareOptions options;
    options.perception.flip = options.perception.ssim = true;
    for (const Limit& limit : {Limit{Metric::Flip, "", 0, 0.5}, Limit{Metric::Ssim, "color", 0, 0.5}}) {
        options.limits = {limit};
        EXPECT_THAT(failuresOf(grey(1), grey(1), options), IsEmpty());
        EXPECT_THAT(failuresOf(grey(0.5), grey(1), options),
                    ElementsAre(HasSubstr("limit: A: RMSE 0.5 exceeds 0")));
        options.limits.push_back({Metric::MaxAbs, "A", 0, 0.5});
        EXPECT_THAT(failuresOf(grey(0.5), grey(1), options), IsEmpty());
        options.limits = {limit, {Metric::Rmse, "", 0, 0.5}};
        EXPECT_THAT(failuresOf(grey(0.5), grey(1), options), IsEmpty()) << "which takes in all channels";
    }
}

TEST(ComparePictures, LayersThatDifferWithoutALimitAreNoted) {
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}};
    const Comparison c = compare(picture(), withValue(3, 0, 0.0f), options);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, ElementsAre(HasSubstr("no limit holds Z, which differ")));
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

TEST(ComparePictures, WhatIsNearlyBlackIsBlack) {
    const auto grey = [](float value, float opacity, float spike) {
        std::vector<float> values(400, value);
        values[7] += spike;
        return pictureOf(
            imageOf(20, 20, {floats("A", std::vector<float>(400, opacity)), floats("Y", values)}));
    };
    for (const float black : {0.0f, 1e-30f, -1e-9f, 4e-7f}) {
        EXPECT_THAT(failuresOf(grey(black, 1, 0), grey(0.5, 1, 0), loose()),
                    ElementsAre("black: color: the first image is black everywhere, the second is not"));
        EXPECT_THAT(failuresOf(grey(0.5, 1, 0), grey(0.5, black, 0), loose()),
                    ElementsAre(HasSubstr("the second image is transparent")));
    }
    EXPECT_THAT(failuresOf(grey(6e-7f, 1, 0), grey(0.5, 1, 0), loose()), IsEmpty());
    EXPECT_THAT(failuresOf(grey(0.5, 1, 0), grey(0.5, 1, 1e7f), loose()), IsEmpty())
        << "beside one pixel that went wrong";
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
    options.channels.only = {"color", "difuse"};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("no channel or layer is called difuse, which --channels names")));
    options.channels.only = {"color"};
    options.channels.without = {"X"};
    const Comparison c = compare(picture(), picture(), options);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, Contains(HasSubstr("called X, which --ignore-channels names")));
}

TEST(ComparePictures, ALimitOnAFigureThatALayerDoesNotHaveFails) {
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}, {Metric::Flip, "Z", 0, 1}};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre("limit: Z: there is no FLIP of layers without colors; --max-rmse Z=X holds it"));
    options.limits = {{Metric::Rmse, "id", 0, 1}};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre("limit: id: there is no RMSE of uint channels; --max-differing id=X holds it"));
}

TEST(ComparePictures, LimitsOfColorsLetNoDepthPassWhereThereAreNoColors) {
    const auto withDepth = [](float z) {
        return pictureOf(imageOf(1, 1, {floats("Z", {z}), uints("id", {1})}));
    };
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1}};
    EXPECT_THAT(failuresOf(withDepth(1), withDepth(2), options),
                ElementsAre(HasSubstr("nothing: no limit holds Z")));
}

TEST(ComparePictures, ALimitThatHoldsNothingIsNoPass) {
    const Picture depth = pictureOf(imageOf(1, 1, {floats("Z", {1})}));
    EXPECT_THAT(failuresOf(depth, depth), IsEmpty()); // equal
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 1e30}}; // of colors
    EXPECT_THAT(failuresOf(depth, depth, options),
                ElementsAre(HasSubstr("nothing: no limit holds Z, for there are no colors")));
    const Picture other = pictureOf(imageOf(1, 1, {floats("Y", {1})}));
    EXPECT_THAT(failuresOf(depth, other, allowing(FindingKind::Channels)),
                ElementsAre(HasSubstr("no channel in common")));
}

} // namespace
} // namespace rt::test
