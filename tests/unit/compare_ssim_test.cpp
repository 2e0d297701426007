#include "tools/rt-compare/ssim.h"

#include "formats/picture.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>

namespace rt {
namespace {

struct Pair {
    std::uint32_t width, height;
    std::vector<float> a, b;
    SsimPlanes planes() const { return {width, height, a, b, {}, false}; }
};

Pair wavesOf(std::uint32_t width, std::uint32_t height) {
    Pair pair{width, height, {}, {}};
    for (double y = 0; y < height; ++y)
        for (double x = 0; x < width; ++x) {
            const double value = 0.5 + 0.5 * std::sin(0.07 * (x + 1) + 0.11 * y);
            pair.a.push_back(static_cast<float>(value));
            pair.b.push_back(static_cast<float>(double(value) + 0.1 * std::sin(0.013 * x * y)));
        }
    return pair;
}

std::optional<double> ssim(const SsimPlanes& planes) {
    return measureSsim(planes, {.single = true}).single;
}
std::optional<double> msSsim(const SsimPlanes& planes) {
    return measureSsim(planes, {.multi = true}).multi;
}
std::vector<float> ssimMap(const SsimPlanes& planes) {
    return measureSsim(planes, {.map = true}).map;
}

Pair constants(std::uint32_t width, std::uint32_t height, float a, float b) {
    const std::size_t count = std::size_t(width) * height;
    return {width, height, std::vector<float>(count, a), std::vector<float>(count, b)};
}

// Of constant planes the variances are 0: what remains is (2ab + C1) / (a^2 + b^2 + C1).
TEST(Ssim, OfConstantPlanesIsHandComputed) {
    const Pair pair = constants(20, 15, 0.25f, 0.75f);
    const double expected = (2 * 0.25 * 0.75 + 1e-4) / (0.0625 + 0.5625 + 1e-4);
    EXPECT_NEAR(ssim(pair.planes()).value(), expected, 1e-7);
    const Pair large = constants(180, 176, 0.25f, 0.75f);
    EXPECT_NEAR(msSsim(large.planes()).value(), std::pow(expected, 0.1333), 1e-7);
}

// Stripes a = 0 1 0 1 ... against b = 1 - a. The weights of even and odd offsets add up to E and 1 - E, so
// that a has the mean p = E or 1 - E, the variance p - p^2, and the covariance with b is the negative of
// that.
TEST(Ssim, OfStripesAndTheirNegativeIsHandComputed) {
    Pair pair{12, 11, {}, {}};
    for (int i = 0; i < 12 * 11; ++i) {
        pair.a.push_back(float(i % 2));
        pair.b.push_back(float(1 - i % 2));
    }
    double even = 0.0, all = 0.0;
    for (int x = -5; x <= 5; ++x) {
        const double weight = std::exp(-x * x / 4.5);
        all += weight;
        if (x % 2 == 0) even += weight;
    }
    const double p = even / all, variance = p - p * p, ab = p * (1 - p);
    const double expected =
        (2 * ab + 1e-4) / (p * p + (1 - p) * (1 - p) + 1e-4) * (-2 * variance + 9e-4) / (2 * variance + 9e-4);
    EXPECT_NEAR(ssim(pair.planes()).value(), expected, 1e-7);
}

// By scikit-image 0.19.3, structural_similarity(gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False, data_range=1), of the same planes.
TEST(Ssim, AgreesWithScikitImage) {
    EXPECT_NEAR(ssim(wavesOf(300, 200).planes()).value(), 0.5933028498439455, 1e-6);
    EXPECT_NEAR(ssim(wavesOf(12, 11).planes()).value(), 0.9762055072453177, 1e-6);
    EXPECT_NEAR(ssim(wavesOf(97, 61).planes()).value(), 0.590972710011381, 1e-6);
    const std::vector<float> map = ssimMap(wavesOf(97, 61).planes());
    EXPECT_NEAR(map[5 * 97 + 5], 0.979497530021258, 1e-6);
    EXPECT_NEAR(map[30 * 97 + 48], 0.8527020184074949, 1e-6);
    EXPECT_NEAR(map[55 * 97 + 91], 0.7682675417390815, 1e-6);
    EXPECT_EQ(map[0], map[5 * 97 + 5]);
    EXPECT_EQ(map[60 * 97 + 96], map[55 * 97 + 91]);
    EXPECT_EQ(map[30 * 97 + 2], map[30 * 97 + 5]);
}

// The last scale by scikit-image, the others by scipy 1.10 gaussian_filter() and the formulas of the paper.
TEST(MsSsim, AgreesWithScipy) {
    EXPECT_NEAR(msSsim(wavesOf(300, 201).planes()).value(), 0.9621073805335616, 1e-6);
}

TEST(Ssim, AgreesWithScikitImageOnPhotographs) {
    if (!std::filesystem::exists(test::scenePath("images/flip/tree-ref.png")))
        GTEST_SKIP() << "no image collection";
    const Picture a = readPicture(test::scenePath("images/flip/tree-ref.png"), {});
    const Picture b = readPicture(test::scenePath("images/flip/tree-test.png"), {});
    double single = 0.0, multi = 0.0;
    for (const char* name : {"R", "G", "B"}) {
        const Image &imageA = a.parts[0].image, &imageB = b.parts[0].image;
        const SsimPlanes planes{
            imageA.width, imageA.height, imageA.find(name)->values, imageB.find(name)->values, {}, false};
        single += ssim(planes).value() / 3.0;
        multi += msSsim(planes).value() / 3.0;
    }
    EXPECT_NEAR(single, 0.7414866150516914, 1e-6);
    EXPECT_NEAR(multi, 0.8692909643969823, 1e-6);
}

TEST(Ssim, IsOneForEqualPlanesAndUndefinedForSmallOnes) {
    Pair pair = wavesOf(200, 180);
    pair.b = pair.a;
    EXPECT_EQ(ssim(pair.planes()), 1.0);
    EXPECT_EQ(msSsim(pair.planes()), 1.0);
    EXPECT_FALSE(ssim(wavesOf(10, 50).planes()));
    EXPECT_FALSE(ssim(wavesOf(50, 10).planes()));
    EXPECT_FALSE(msSsim(wavesOf(175, 300).planes()));
    EXPECT_TRUE(msSsim(wavesOf(176, 176).planes()));
}

TEST(Ssim, IgnoredPixelsAreNoMiddleOfAWindow) {
    const Pair pair = wavesOf(97, 61);
    SsimPlanes planes = pair.planes();
    std::vector<std::uint8_t> ignored(97 * 61, 1);
    planes.ignored = ignored;
    EXPECT_EQ(ssim(planes), 1.0);
    ignored[30 * 97 + 48] = 0;
    EXPECT_NEAR(ssim(planes).value(), ssimMap(planes)[30 * 97 + 48], 1e-7);
}

TEST(Ssim, FiguresDoNotDependOnWhatElseIsWanted) {
    const Pair pair = wavesOf(211, 183);
    const SsimFigures all = measureSsim(pair.planes(), {true, true, true});
    EXPECT_EQ(all.single, ssim(pair.planes()));
    EXPECT_EQ(all.multi, msSsim(pair.planes()));
    EXPECT_EQ(all.map, ssimMap(pair.planes()));
    EXPECT_LT(all.single.value(), 0.999);
    const SsimFigures map = measureSsim(pair.planes(), {.map = true});
    EXPECT_FALSE(map.single || map.multi);
    EXPECT_TRUE(measureSsim(pair.planes(), {.multi = true}).map.empty());
}

TEST(Ssim, IsTheSameForAnyNumberOfThreads) {
    const Pair pair = wavesOf(300, 200);
    const auto one = ssim(pair.planes()), oneMulti = msSsim(pair.planes());
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(ssim(pair.planes()), one);
    EXPECT_EQ(msSsim(pair.planes()), oneMulti);
}

} // namespace
} // namespace rt
