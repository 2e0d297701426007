#include "tools/rt-compare/flip.h"

#include "formats/picture.h"
#include "tests/support/scenes.h"
#include "tools/rt-compare/float_lanes.h"
#include "tools/rt-compare/pool_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <functional>

namespace rt {
namespace {

using Encoding = ColorPlanes::Encoding;

struct Colors {
    std::uint32_t width = 0, height = 0;
    std::vector<float> values[3];

    ColorPlanes planes(Encoding encoding = Encoding::Linear) const {
        return {width, height, {values[0], values[1], values[2]}, encoding};
    }
};

Colors colorsOf(std::uint32_t width, std::uint32_t height,
                const std::function<double(double x, double y, double channel)>& value) {
    Colors colors{width, height, {}};
    for (int c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                colors.values[c].push_back(static_cast<float>(value(x, y, c)));
    return colors;
}

Colors constantOf(std::uint32_t width, std::uint32_t height, double value) {
    return colorsOf(width, height, [value](double, double, double) { return value; });
}

double wave(double x, double y, double c) {
    return 0.5 + 0.5 * std::sin(0.07 * (x + 1) * (c + 1) + 0.11 * y);
}
double brightWave(double x, double y, double c) {
    return std::exp(3.0 * std::sin(0.05 * (x + 1) * (c + 1) + 0.09 * y));
}

// Wider and higher than a tile.
Colors waves() {
    return colorsOf(300, 140, wave);
}
Colors disturbedWaves() {
    return colorsOf(300, 140, [](double x, double y, double c) {
        return double(float(wave(x, y, c))) + 0.1 * std::sin(0.013 * x * y + c);
    });
}
Colors brightWaves() {
    return colorsOf(300, 140, brightWave);
}
Colors disturbedBrightWaves() {
    return colorsOf(300, 140, [](double x, double y, double c) {
        return brightWave(x, y, c) * (1.0 + 0.2 * std::sin(0.013 * x * y + c));
    });
}

struct Expected {
    double mean, weightedMedian, firstQuartile, thirdQuartile, min, max;
    double atPixels[5]; ///< (0, 0), (11, 7), (290, 100), (299, 139), (128, 63)
};

void expectErrors(const std::vector<float>& errors, const Expected& expected) {
    const PooledErrors pooled = poolErrors(errors);
    EXPECT_NEAR(pooled.mean, expected.mean, 2e-6);
    EXPECT_NEAR(pooled.weightedMedian, expected.weightedMedian, 2e-5);
    EXPECT_NEAR(pooled.firstWeightedQuartile, expected.firstQuartile, 2e-5);
    EXPECT_NEAR(pooled.thirdWeightedQuartile, expected.thirdQuartile, 2e-5);
    EXPECT_NEAR(pooled.min, expected.min, 2e-5);
    EXPECT_NEAR(pooled.max, expected.max, 2e-5);
    const std::size_t pixels[5] = {0, 7 * 300 + 11, 100 * 300 + 290, 139 * 300 + 299, 63 * 300 + 128};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(errors[pixels[i]], expected.atPixels[i], 2e-5) << i;
}

// The expected values of the waves were computed once by a transcription of the papers' formulas in double
// precision with numpy 1.24 and scipy 1.10: whole 2D kernels by scipy.ndimage.correlate(mode='nearest'),
// nothing taken apart, and the same inputs rounded to float.
TEST(Flip, AgreesWithADoublePrecisionTranscriptionOfThePaper) {
    const Colors a = waves(), b = disturbedWaves();
    expectErrors(flipLdr(a.planes(), b.planes()), {0.1283364,
                                                   0.1505443,
                                                   0.1067179,
                                                   0.2245465,
                                                   0.002896,
                                                   0.7110708,
                                                   {0.2537529, 0.2961872, 0.1393219, 0.1327343, 0.0706156}});
    expectErrors(flipLdr(a.planes(), b.planes(), 30.0),
                 {0.2314946,
                  0.2610887,
                  0.1950435,
                  0.3319952,
                  0.0241499,
                  0.7631435,
                  {0.2382864, 0.296241, 0.1313964, 0.2349619, 0.2699187}});
    expectErrors(flipLdr(a.planes(), b.planes(), 120.0),
                 {0.097097,
                  0.1107311,
                  0.0805707,
                  0.1596072,
                  0.0017403,
                  0.6341891,
                  {0.2692484, 0.2541576, 0.1156591, 0.1192239, 0.0344546}});
    expectErrors(flipLdr(a.planes(Encoding::Srgb), b.planes(Encoding::Srgb)),
                 {0.1442281,
                  0.1744625,
                  0.1151492,
                  0.245826,
                  0.0050151,
                  0.5152292,
                  {0.3775788, 0.4647477, 0.2576094, 0.2654883, 0.0493028}});
}

TEST(Flip, OfHdrAgreesWithADoublePrecisionTranscriptionOfThePaper) {
    const Colors a = brightWaves(), b = disturbedBrightWaves();
    const ExposureRange automatic = automaticExposures(a.planes(), b.planes()).range;
    EXPECT_NEAR(automatic.start, -3.2445114, 1e-5);
    EXPECT_NEAR(automatic.stop, -0.5132214, 5e-4); // the median is the mean of two values there, one here
    EXPECT_EQ(automatic.count, 3u);
    expectErrors(flipHdr(a.planes(), b.planes(), automatic),
                 {0.0591789,
                  0.0866163,
                  0.0399987,
                  0.1512338,
                  0.0019596,
                  0.3181079,
                  {0.2258723, 0.1290124, 0.0302939, 0.038678, 0.0596786}});
    expectErrors(flipHdr(a.planes(), b.planes(), {-1.0, 2.0, 4}),
                 {0.0556015,
                  0.0832351,
                  0.0384297,
                  0.1456269,
                  0.0035959,
                  0.3011668,
                  {0.1941323, 0.0574561, 0.0278418, 0.0898475, 0.0684338}});
}

struct PublishedPair {
    const char *reference, *test;
    double mean, weightedMedian, firstQuartile, thirdQuartile, max;
};

Colors readColors(const char* path) {
    const Picture picture = readPicture(test::scenePath(std::string("images/") + path), {});
    const Image& image = picture.parts.front().image;
    Colors colors{image.width, image.height, {}};
    const char* const names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) colors.values[c] = image.find(names[c])->values;
    return colors;
}

// Figures of NVlabs/flip 1.6 for 67 pixels per degree, and those that nv-flip-rs publishes for the first pair
// within 1e-4.
TEST(Flip, AgreesWithTheReferenceImplementationOnPublishedPairs) {
    if (!std::filesystem::exists(test::scenePath("images/flip/tree-ref.png")))
        GTEST_SKIP() << "no image collection";
    for (const PublishedPair& pair :
         {PublishedPair{"flip/tree-ref.png", "flip/tree-test.png", 0.133276, 0.333201, 0.184897, 0.503424,
                        0.983034},
          {"pixelmatch/1a.png", "pixelmatch/1b.png", 0.009093, 0.067294, 0.043500, 0.102358, 0.887693},
          {"pixelmatch/3a.png", "pixelmatch/3b.png", 0.003328, 0.326101, 0.165290, 0.469635, 0.603944},
          {"pixelmatch/6a.png", "pixelmatch/6b.png", 0.099698, 0.179606, 0.104566, 0.279906, 0.668477}}) {
        SCOPED_TRACE(pair.reference);
        const Colors a = readColors(pair.reference), b = readColors(pair.test);
        const PooledErrors pooled = poolErrors(flipLdr(a.planes(Encoding::Srgb), b.planes(Encoding::Srgb)));
        EXPECT_NEAR(pooled.mean, pair.mean, 3e-6);
        EXPECT_NEAR(pooled.weightedMedian, pair.weightedMedian, 3e-6);
        EXPECT_NEAR(pooled.firstWeightedQuartile, pair.firstQuartile, 3e-6);
        EXPECT_NEAR(pooled.thirdWeightedQuartile, pair.thirdQuartile, 3e-6);
        EXPECT_EQ(pooled.min, 0.0);
        EXPECT_NEAR(pooled.max, pair.max, 3e-6);
    }
}

TEST(Flip, IsZeroForEqualPicturesAndSymmetric) {
    const Colors a = waves(), b = disturbedWaves();
    EXPECT_THAT(flipLdr(a.planes(), a.planes()), testing::Each(0.0f));
    EXPECT_THAT(flipHdr(b.planes(), b.planes(), {-4.0, 4.0, 9}), testing::Each(0.0f));
    EXPECT_EQ(flipLdr(a.planes(), b.planes()), flipLdr(b.planes(), a.planes()));
}

// Tiles are left out where nothing can be seen: not where a pixel of the next tile is.
TEST(Flip, OfOneDifferentPixelIsSeenAllAroundIt) {
    const Colors a = constantOf(600, 300, 0.5);
    for (const std::size_t x : {253u, 255u, 256u, 258u}) {
        Colors b = a;
        b.values[1][100 * 600 + x] = 1.0f;
        const std::vector<float> errors = flipLdr(a.planes(), b.planes());
        for (std::size_t i = 1; i < 6; ++i) {
            EXPECT_GT(errors[100 * 600 + x - i], 0.0f) << x << " " << i;
            EXPECT_NEAR(errors[100 * 600 + x - i], errors[100 * 600 + x + i], 1e-4f);
        }
        EXPECT_EQ(errors[100 * 600 + x + 30], 0.0f);
        EXPECT_EQ(errors[299 * 600], 0.0f);
    }
}

TEST(Flip, IsTheSameForAnyNumberOfThreads) {
    const Colors a = brightWaves(), b = disturbedBrightWaves();
    const std::vector<float> all = flipHdr(a.planes(), b.planes(), {-2.0, 2.0, 3});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(all, flipHdr(a.planes(), b.planes(), {-2.0, 2.0, 3}));
}

// Green and blue have L* 87.7 and 32.3, a* and b* times L* / 100 -75.6, 73.0 and 25.6, -34.8: 55.4 + 147.9
// apart, the most there is. Black and white are 100 apart. All to the power of 0.7.
TEST(Flip, OfBlackAndWhiteIsHandComputed) {
    const std::vector<float> errors =
        flipLdr(constantOf(20, 9, 0.0).planes(), constantOf(20, 9, 1.0).planes());
    EXPECT_EQ(errors.size(), 180u);
    const double most = std::pow(203.3, 0.7), difference = std::pow(100.0, 0.7);
    const double expected = 0.95 + 0.05 * (difference - 0.4 * most) / (0.6 * most);
    EXPECT_THAT(errors, testing::Each(testing::FloatNear(float(expected), 1e-4f)));
}

TEST(Flip, TakesPicturesOfOnePixel) {
    EXPECT_EQ(flipLdr(constantOf(1, 1, 0.3).planes(), constantOf(1, 1, 0.3).planes()),
              std::vector<float>{0.0f});
    EXPECT_GT(flipLdr(constantOf(1, 1, 0.3).planes(), constantOf(1, 1, 0.4).planes())[0], 0.05f);
}

TEST(Flip, TakesWhatIsNotFiniteAsBlackAndStaysFinite) {
    Colors bad = waves();
    bad.values[0][500] = std::nanf("");
    bad.values[1][9000] = INFINITY;
    bad.values[2][20000] = -INFINITY;
    Colors black = waves();
    black.values[0][500] = black.values[1][9000] = black.values[2][20000] = 0.0f;
    EXPECT_EQ(flipLdr(waves().planes(), bad.planes()), flipLdr(waves().planes(), black.planes()));
    const Colors huge = constantOf(30, 30, 3e38);
    for (const float error : flipHdr(huge.planes(), constantOf(30, 30, -3e38).planes(), {-100.0, 100.0, 5}))
        EXPECT_TRUE(error > 0.9f && error <= 1.0f);
}

// A small square on black: most pixels, and so the median, are black.
Colors squareOf(double value, double background = 0.0) {
    return colorsOf(64, 64, [=](double x, double y, double) {
        return x >= 20 && x < 40 && y >= 20 && y < 40 ? value : background;
    });
}

TEST(FlipExposures, SeeTheSquareOnABlackBackground) {
    for (const double background : {0.0, 1e-30}) {
        const Colors reference = squareOf(2.0, background), other = squareOf(1.0, background);
        const auto [range, note] = automaticExposures(reference.planes(), other.planes());
        EXPECT_THAT(note, testing::HasSubstr("most pixels are black"));
        EXPECT_TRUE(std::isfinite(range.start) && std::isfinite(range.stop));
        EXPECT_NEAR(range.start, range.stop, 1e-9); // all that is lit is equally bright
        EXPECT_EQ(range.count, 1u);
        const PooledErrors pooled = poolErrors(flipHdr(reference.planes(), other.planes(), range));
        EXPECT_GT(pooled.max, 0.3);
        EXPECT_GT(pooled.mean, 0.02);
    }
}

TEST(FlipExposures, TakeConstantAndBlackReferences) {
    const Colors black = constantOf(16, 16, 0.0), grey = constantOf(16, 16, 0.18),
                 dark = constantOf(16, 16, -1.0);
    const ExposureRange constant = automaticExposures(grey.planes(), black.planes()).range;
    EXPECT_EQ(constant.count, 1u);
    EXPECT_GT(poolErrors(flipHdr(grey.planes(), black.planes(), constant)).mean, 0.9);
    const ExposureRange fromTest = automaticExposures(black.planes(), grey.planes()).range;
    EXPECT_EQ(fromTest.start, constant.start);
    EXPECT_GT(poolErrors(flipHdr(black.planes(), grey.planes(), fromTest)).mean, 0.9);
    for (const Colors& other : {black, dark}) {
        const ExposureRange none = automaticExposures(black.planes(), other.planes()).range;
        EXPECT_EQ(none.start, 0.0);
        EXPECT_EQ(none.count, 1u);
        EXPECT_EQ(poolErrors(flipHdr(black.planes(), other.planes(), none)).max, 0.0);
    }
}

TEST(FlipExposures, AreAtMost33AndIgnoreWhatIsNotFinite) {
    Colors wide = colorsOf(64, 64, [](double x, double, double) { return std::exp2(x * 4.0 - 126.0); });
    EXPECT_LE(automaticExposures(wide.planes(), wide.planes()).range.count, 33u);
    Colors grey = constantOf(16, 16, 0.5);
    const ExposureRange before = automaticExposures(grey.planes(), grey.planes()).range;
    grey.values[0][3] = INFINITY;
    grey.values[0][4] = std::nanf("");
    const ExposureRange after = automaticExposures(grey.planes(), grey.planes()).range;
    EXPECT_EQ(before.start, after.start);
    EXPECT_EQ(before.stop, after.stop);
}

TEST(FlipExposures, APixelWithoutMeasureHidesNoOther) {
    for (const int side : {8, 64})
        for (const float spike : {1e6f, 1e9f, 1e10f, 1e20f, 3e38f}) {
            Colors reference = constantOf(std::uint32_t(side), std::uint32_t(side), 0.5);
            const Colors test = constantOf(std::uint32_t(side), std::uint32_t(side), 0.25);
            for (std::vector<float>& plane : reference.values) plane[3] = spike;
            const ExposureRange range = automaticExposures(reference.planes(), test.planes()).range;
            EXPECT_LE(range.count, 33u);
            EXPECT_GT(poolErrors(flipHdr(reference.planes(), test.planes(), range)).mean, 0.2)
                << side << " pixels a side, one " << spike;
        }
}

TEST(FlipExposures, ShowNothingWhereAllIsBlackOrWhite) {
    const Colors picture = squareOf(2.0, 0.1);
    for (const double stops : {-100.0, -14.0, 14.0, 100.0})
        EXPECT_FALSE(showsAnything(picture.planes(), {stops, stops, 1})) << stops;
    EXPECT_TRUE(showsAnything(picture.planes(), {0.0, 0.0, 1}));
    EXPECT_TRUE(showsAnything(picture.planes(), {-100.0, 0.0, 2}));
    EXPECT_FALSE(showsAnything(constantOf(16, 16, 0.0).planes(), {0.0, 0.0, 1}));
}

TEST(FlipExposures, GoEvenlyFromStartToStop) {
    const ExposureRange range{-2.0, 1.0, 4};
    EXPECT_DOUBLE_EQ(range.factor(0), 0.25);
    EXPECT_DOUBLE_EQ(range.factor(1), 0.5);
    EXPECT_DOUBLE_EQ(range.factor(3), 2.0);
    EXPECT_DOUBLE_EQ((ExposureRange{3.0, 3.0, 1}.factor(0)), 8.0);
}

TEST(PoolErrors, HandComputedFiguresWeighErrorsByTheirSize) {
    // Ascending 0 0.1 0.2 0.3 0.4: sums 0 0.1 0.3 0.6 1.0.
    const std::vector<float> errors{0.4f, 0.0f, 0.2f, 0.1f, 0.3f};
    const PooledErrors pooled = poolErrors(errors);
    EXPECT_NEAR(pooled.mean, 0.2, 1e-7);
    EXPECT_EQ(pooled.min, 0.0);
    EXPECT_EQ(pooled.max, 0.4f);
    EXPECT_EQ(pooled.firstWeightedQuartile, 0.2f);
    EXPECT_EQ(pooled.weightedMedian, 0.3f);
    EXPECT_EQ(pooled.thirdWeightedQuartile, 0.4f);
    ASSERT_EQ(pooled.percentiles.size(), 3u);
    EXPECT_EQ(pooled.percentiles[0].absError, double(0.2f));
    EXPECT_EQ(pooled.percentiles[1].absError, double(0.4f));
    EXPECT_EQ(pooled.percentiles[2].absError, double(0.4f));
    const std::vector<float> zeros(7, 0.0f);
    EXPECT_EQ(poolErrors(zeros).weightedMedian, 0.0);
}

void expectClose(Floats (*function)(const Floats&), double (*exact)(double), double low, double high,
                 double tolerance, bool isRelative) {
    for (int i = 0; i <= 20000; ++i) {
        const float x = static_cast<float>(low * std::pow(high / low, i / 20000.0));
        const double expected = exact(x), got = function(allFloats(x))[i % 8];
        EXPECT_NEAR(got, expected, tolerance * (isRelative ? std::abs(expected) : 1.0)) << x;
    }
}

TEST(FloatLanes, FunctionsAreAsExactAsTheySay) {
    expectClose(squareRoot, std::sqrt, 1e-30, 1e30, 3e-7, true);
    expectClose(cubeRoot, std::cbrt, 1e-9, 1e9, 3e-7, true);
    expectClose(log2Of, std::log2, 0.25, 4.0, 2e-7, false);
    expectClose(exp2Of, std::exp2, 1e-3, 126.0, 3e-7, true);
    EXPECT_EQ(squareRoot(allFloats(0.0f))[0], 0.0f);
    EXPECT_EQ(power(allFloats(0.0f), allFloats(0.7f))[0], 0.0f);
    EXPECT_EQ(power(allFloats(1.0f), allFloats(0.7f))[0], 1.0f);
    EXPECT_NEAR(power(allFloats(0.2f), allFloats(2.4f))[0], std::pow(0.2, 2.4), 1e-7);
}

} // namespace
} // namespace rt
