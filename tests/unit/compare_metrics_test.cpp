#include "tests/support/compared_layers.h"
#include "tests/support/scenes.h"
#include "tests/support/split_mix.h"
#include "tests/support/test_pictures.h"
#include "tools/rt-compare/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace rt::test {
namespace {

// 2x2 pixels, differences by hand: B 0 0 0 0, G 0.5 0 0 0, R 0 -1 0 2.
Image handA() {
    return imageOf(2, 2, {floats("B", {1, 2, 3, 4}), floats("G", {1, 1, 1, 1}), floats("R", {0, 1, 2, 3})});
}
Image handB() {
    return imageOf(2, 2,
                   {floats("B", {1, 2, 3, 4}), floats("G", {0.5f, 1, 1, 1}), floats("R", {0, 2, 2, 1})});
}

Comparison compare(const Image& a, const Image& b, const CompareOptions& options = {},
                   const SidePictures& side = {}) {
    return comparePictures(pictureOf(a), pictureOf(b), options, side).comparison;
}

ErrorFigures figuresOf(float a, float b, double peak = 1.0) {
    CompareOptions options;
    options.metrics.peak = peak;
    return colorOf(compare(imageOf(1, 1, {floats("R", {a})}), imageOf(1, 1, {floats("R", {b})}), options))
        ->figures;
}

TEST(CompareMetrics, FiguresOfALayerAreThoseByHand) {
    const Comparison c = compare(handA(), handB());
    const ErrorFigures& f = colorOf(c)->figures;
    EXPECT_EQ(colorOf(c)->name, "color");
    EXPECT_EQ(f.values, 12u);
    EXPECT_EQ(f.compared, 12u);
    EXPECT_DOUBLE_EQ(f.maxAbs, 2.0);
    EXPECT_DOUBLE_EQ(f.bias, 1.5 / 12.0);
    EXPECT_DOUBLE_EQ(f.mae, 3.5 / 12.0);
    EXPECT_DOUBLE_EQ(f.mse, 5.25 / 12.0);
    EXPECT_DOUBLE_EQ(f.rmse, std::sqrt(5.25 / 12.0));
    EXPECT_DOUBLE_EQ(f.relMse, (0.25 / 0.26 + 1.0 / 4.01 + 4.0 / 1.01) / 12.0);
    EXPECT_DOUBLE_EQ(f.smape, (0.5 / 1.51 + 1.0 / 3.01 + 2.0 / 4.01) / 12.0);
    EXPECT_DOUBLE_EQ(f.psnr, -10.0 * std::log10(5.25 / 12.0));
    EXPECT_EQ(f.a.min, 0.0);
    EXPECT_EQ(f.a.max, 4.0);
    EXPECT_DOUBLE_EQ(f.a.mean, 20.0 / 12.0);
    EXPECT_DOUBLE_EQ(f.b.mean, 18.5 / 12.0);
}

TEST(CompareMetrics, FiguresOfEachChannelAreThoseByHand) {
    const std::vector<ChannelComparison> channels = colorOf(compare(handA(), handB()))->channels;
    ASSERT_EQ(channels.size(), 3u);
    EXPECT_EQ(channels[0].name, "R");
    EXPECT_DOUBLE_EQ(channels[0].figures.rmse, std::sqrt(5.0 / 4.0));
    EXPECT_DOUBLE_EQ(channels[0].figures.mae, 0.75);
    EXPECT_EQ(channels[1].name, "G");
    EXPECT_DOUBLE_EQ(channels[1].figures.rmse, 0.25);
    EXPECT_DOUBLE_EQ(channels[1].figures.maxAbs, 0.5);
    EXPECT_EQ(channels[2].name, "B");
    EXPECT_DOUBLE_EQ(channels[2].figures.rmse, 0.0);
    EXPECT_EQ(channels[2].figures.psnr, std::numeric_limits<double>::infinity());
}

TEST(CompareMetrics, PsnrTakesItsPeak) {
    EXPECT_DOUBLE_EQ(figuresOf(1.0f, 0.0f).psnr, 0.0);
    EXPECT_NEAR(figuresOf(1.0f, 0.0f, 255.0).psnr, 48.130803608679105, 1e-12); // 20 log10(255)
}

TEST(CompareMetrics, PixelsOverAThresholdCountOnceWhateverTheNumberOfChannels) {
    CompareOptions options;
    options.metrics.thresholds = {0.0, 0.5, 1.0};
    const Comparison c = compare(handA(), handB(), options);
    const std::vector<OverThreshold>& over = colorOf(c)->figures.over;
    ASSERT_EQ(over.size(), 3u);
    EXPECT_EQ(over[0].pixels, 3u); // not 4 values: one per pixel
    EXPECT_EQ(over[1].pixels, 2u); // 0.5 is not over 0.5
    EXPECT_EQ(over[2].pixels, 1u);
    EXPECT_DOUBLE_EQ(over[2].fraction, 0.25);
    EXPECT_EQ(colorOf(c)->channels[0].figures.over[0].pixels, 2u);
    Image both = handB();
    both.channels[1].values[1] = 7.0f;
    EXPECT_EQ(colorOf(compare(handA(), both, options))->figures.over[0].pixels, 3u);
}

TEST(CompareMetrics, WorstPixelsAreListedWithPositionAndBothValues) {
    CompareOptions options;
    options.metrics.worst = 2;
    const std::vector<WorstPixel> worst = colorOf(compare(handA(), handB(), options))->worst;
    ASSERT_EQ(worst.size(), 2u);
    EXPECT_EQ(worst[0].channel, "R");
    EXPECT_EQ(worst[0].x, 1);
    EXPECT_EQ(worst[0].y, 1);
    EXPECT_EQ(worst[0].a, 3.0);
    EXPECT_EQ(worst[0].b, 1.0);
    EXPECT_EQ(worst[1].x, 1);
    EXPECT_EQ(worst[1].y, 0);
    options.metrics.worst = 100;
    EXPECT_EQ(colorOf(compare(handA(), handB(), options))->worst.size(), 3u)
        << "pixels that do not differ are none";
    EXPECT_TRUE(colorOf(compare(handA(), handA()))->worst.empty());
}

TEST(CompareMetrics, TheHistogramCountsByPowersOfTwo) {
    const ErrorHistogram histogram = colorOf(compare(handA(), handB()))->figures.histogram;
    const auto binOf = [](int exponent) {
        return static_cast<std::size_t>(exponent - ErrorHistogram::kLowestExponent + 1);
    };
    EXPECT_EQ(histogram.counts[0], 9u);
    EXPECT_EQ(histogram.counts[binOf(-1)], 1u);
    EXPECT_EQ(histogram.counts[binOf(0)], 1u);
    EXPECT_EQ(histogram.counts[binOf(1)], 1u);
    const auto tiny = compare(imageOf(1, 1, {floats("R", {1e-45f})}), imageOf(1, 1, {floats("R", {0})}));
    EXPECT_EQ(colorOf(tiny)->figures.histogram.counts[0], 0u) << "a difference is none of the equal values";
    EXPECT_EQ(colorOf(tiny)->figures.histogram.counts[1], 1u);
}

TEST(CompareMetrics, SumsDoNotOverflowOrCancelWhereFloatsWould) {
    constexpr float kMax = std::numeric_limits<float>::max();
    EXPECT_DOUBLE_EQ(figuresOf(kMax, -kMax).rmse, 2.0 * double(kMax));
    EXPECT_DOUBLE_EQ(figuresOf(1e-30f, 0.0f).rmse, double(1e-30f));
    EXPECT_GT(figuresOf(1e-45f, 0.0f).rmse, 0.0);
}

// Random pictures of three scales, with equal values among them and, where `mask` is given, a mask.
struct RandomPair {
    Image a, b;
    std::vector<double> errors; // |a - b| in single precision, of all values not masked
    RandomPair(std::uint64_t seed, std::uint32_t width, std::uint32_t height, const Image* mask = nullptr) {
        RayNumbers numbers(seed, 0);
        for (const char* name : {"B", "G", "R"}) {
            std::vector<float> va, vb;
            for (std::size_t i = 0; i < std::size_t(width) * height; ++i) {
                va.push_back(numbers.between(-1.0f, 1.0f));
                const float scale = std::pow(10.0f, numbers.between(-6.0f, 2.0f));
                vb.push_back(numbers.unit() < 0.3f ? va.back()
                                                   : va.back() + scale * numbers.between(-1.0f, 1.0f));
                if (mask && mask->channels[0].values[i] == 0.0f) continue;
                errors.push_back(double(static_cast<float>(std::abs(double(va.back()) - double(vb.back())))));
            }
            a.channels.push_back(floats(name, va));
            b.channels.push_back(floats(name, vb));
        }
        a.width = b.width = width;
        a.height = b.height = height;
        std::ranges::sort(errors);
    }
};

TEST(CompareMetrics, PercentilesAreThoseOfSortedErrors) {
    CompareOptions options;
    options.metrics.percents = {0.001, 10, 31, 50, 90, 99, 99.9, 100};
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const RandomPair pair(seed, 157, 61);
        const Comparison c = compare(pair.a, pair.b, options);
        ASSERT_EQ(colorOf(c)->figures.percentiles.size(), 8u);
        for (const Percentile& p : colorOf(c)->figures.percentiles) {
            const auto rank =
                static_cast<std::size_t>(std::ceil(p.percent / 100.0 * double(pair.errors.size())));
            EXPECT_EQ(p.absError, std::min(pair.errors[rank - 1], colorOf(c)->figures.maxAbs)) << p.percent;
        }
    }
}

TEST(CompareMetrics, AMaskTakesItsPixelsOutOfEveryFigure) {
    Image mask = imageOf(157, 61, {floats("Y", std::vector<float>(157 * 61, 1.0f))});
    for (std::size_t i = 0; i < 157 * 61; i += 3) mask.channels[0].values[i] = 0.0f;
    const RandomPair pair(4, 157, 61, &mask);
    const Picture maskPicture = pictureOf(mask);
    const Comparison c = compare(pair.a, pair.b, {}, {&maskPicture});
    const ErrorFigures& f = colorOf(c)->figures;
    EXPECT_EQ(f.values, pair.errors.size());
    EXPECT_EQ(c.ignored, 157u * 61u - pair.errors.size() / 3u);
    EXPECT_EQ(f.percentiles[0].absError,
              pair.errors[pair.errors.size() / 2 - (pair.errors.size() % 2 ? 0 : 1)]);
    double sum = 0.0;
    for (const double error : pair.errors) sum += error;
    EXPECT_NEAR(f.mae, sum / double(pair.errors.size()), 1e-6 * f.mae);
    std::uint64_t counted = 0;
    for (const std::uint64_t count : f.histogram.counts) counted += count;
    EXPECT_EQ(counted, f.compared);
    std::uint64_t differing = 0;
    for (std::size_t i = 0; i < 157 * 61; ++i)
        if (mask.channels[0].values[i] != 0.0f)
            for (std::size_t channel = 0; channel < 3; ++channel)
                if (pair.a.channels[channel].values[i] != pair.b.channels[channel].values[i]) {
                    ++differing;
                    break;
                }
    EXPECT_EQ(f.over[0].pixels, differing);
}

TEST(CompareMetrics, FiguresDoNotDependOnTheNumberOfThreads) {
    const RandomPair pair(5, 640, 97);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return *colorOf(compare(pair.a, pair.b));
    };
    const LayerComparison one = run(1), many = run(4);
    EXPECT_EQ(one.figures.mse, many.figures.mse);
    EXPECT_EQ(one.figures.relMse, many.figures.relMse);
    EXPECT_EQ(one.figures.smape, many.figures.smape);
    EXPECT_EQ(one.figures.bias, many.figures.bias);
    EXPECT_EQ(one.figures.histogram.counts, many.figures.histogram.counts);
    ASSERT_EQ(one.worst.size(), 5u);
    ASSERT_EQ(many.worst.size(), 5u);
    for (std::size_t i = 0; i < one.worst.size(); ++i) {
        EXPECT_EQ(one.worst[i].channel, many.worst[i].channel);
        EXPECT_EQ(one.worst[i].x, many.worst[i].x);
        EXPECT_EQ(one.worst[i].y, many.worst[i].y);
    }
}

TEST(CompareMetrics, UintChannelsAreComparedByEveryBit) {
    const Image a = imageOf(2, 2, {uints("id", {1, 2, 0xFFFFFFFFu, 16777216u})});
    const Image b = imageOf(2, 2, {uints("id", {1, 3, 0xFFFFFFFFu, 16777217u})}); // equal as floats
    const Comparison c = compare(a, b);
    ASSERT_EQ(c.layers.size(), 1u);
    EXPECT_EQ(c.layers[0].kind, LayerKind::Ids);
    EXPECT_EQ(c.layers[0].channels[0].differing, 2u);
    EXPECT_DOUBLE_EQ(c.layers[0].figures.over[0].fraction, 0.5);
    EXPECT_EQ(c.layers[0].worst[1].a, 16777216.0);
    EXPECT_EQ(c.layers[0].worst[1].b, 16777217.0);
}

// The published figures are of numbers from 0 to 255.
struct PublishedPng {
    const char *a, *b;
    double mae, rmse, maxAbs, psnr;
    std::uint64_t differing;
};

TEST(CompareMetrics, AgreesWithPublishedValuesOfPngPairs) {
    const PublishedPng pairs[] = {
        {"flip/tree-ref.png", "flip/tree-test.png", 8.55355143, 19.6035236, 221, 22.284121, 436168},
        {"pixelmatch/1a.png", "pixelmatch/1b.png", 0.291859945, 3.16005565, 255, 38.136909, 12933},
        {"pixelmatch/3a.png", "pixelmatch/3b.png", 0.238375346, 5.3846054, 228, 33.507726, 583},
        {"pixelmatch/6a.png", "pixelmatch/6b.png", 4.5185496, 19.726765, 255, 22.229686, 4900}};
    if (!std::filesystem::is_directory(scenePath("images/flip"))) GTEST_SKIP() << "no scenes";
    for (const PublishedPng& pair : pairs) {
        CompareOptions options;
        options.channels.only = {"R", "G", "B"};
        const Comparison c =
            comparePictures(readPicture(scenePath(std::string("images/") + pair.a), {}),
                            readPicture(scenePath(std::string("images/") + pair.b), {}), options)
                .comparison;
        const ErrorFigures& f = colorOf(c)->figures;
        EXPECT_NEAR(255.0 * f.mae, pair.mae, 1e-6);
        EXPECT_NEAR(255.0 * f.rmse, pair.rmse, 1e-6);
        EXPECT_NEAR(255.0 * f.maxAbs, pair.maxAbs, 1e-4);
        EXPECT_NEAR(f.psnr, pair.psnr, 1e-6);
        EXPECT_EQ(f.over[0].pixels, pair.differing);
        EXPECT_EQ(c.nonFiniteA.total() + c.nonFiniteB.total(), 0u);
    }
}

TEST(CompareMetrics, AgreesWithReferenceValuesOfRealRenders) {
    // Computed over R, G and B by another program.
    const struct {
        const char *a, *b;
        double mae, rmse, maxAbs;
        std::uint64_t differing;
    } pairs[] = {{"oriented_bspline_curve_twisted.ecs.embree_pathtracer.exr",
                  "oriented_hermite_curve_twisted.ecs.embree_pathtracer.exr", 6.65353031e-05, 0.00667387973,
                  0.937254965, 735},
                 {"mblur_time_range_grid.ecs.embree_viewer.exr",
                  "mblur_time_range_quad.ecs.embree_viewer.exr", 0.0, 0.0, 0.0, 0},
                 {"hair0.ecs.embree_viewer.exr", "hair0.ecs.embree_viewer_grid.exr", 0.166398511, 0.260161247,
                  0.909803987, 147983}};
    if (!std::filesystem::is_directory(scenePath("images/pairs"))) GTEST_SKIP() << "no scenes";
    for (const auto& pair : pairs) {
        const Comparison c =
            comparePictures(readPicture(scenePath(std::string("images/pairs/") + pair.a), {}),
                            readPicture(scenePath(std::string("images/pairs/") + pair.b), {}), {})
                .comparison;
        EXPECT_NEAR(colorOf(c)->figures.mae, pair.mae, 1e-9);
        EXPECT_NEAR(colorOf(c)->figures.rmse, pair.rmse, 1e-9);
        EXPECT_NEAR(colorOf(c)->figures.maxAbs, pair.maxAbs, 1e-9);
        EXPECT_EQ(colorOf(c)->figures.over[0].pixels, pair.differing);
        EXPECT_EQ(c.passed(), pair.rmse == 0.0);
    }
}

} // namespace
} // namespace rt::test
