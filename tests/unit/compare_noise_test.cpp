#include "common/error.h"
#include "tests/support/test_pictures.h"
#include "tools/rt-compare/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace rt::test {
namespace {

constexpr std::uint32_t kSize = 256;

/// What one sample of a pixel may bring.
using Sampler = std::function<double(std::mt19937_64& random, std::uint32_t x, std::uint32_t y)>;

double gaussian(std::mt19937_64& random, std::uint32_t x, std::uint32_t y) {
    const double mean = 0.6 + 0.4 * std::sin(0.03 * x) * std::cos(0.05 * y);
    return mean * (1.0 + std::normal_distribution<double>(0.0, 0.8)(random));
}

/// Fireflies: most samples are dark, a few very bright.
double fireflies(std::mt19937_64& random, std::uint32_t, std::uint32_t) {
    const double u = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    return u < 0.001 ? 300.0 : 0.3 * u;
}

/// Half of the pixels in a checkerboard are free of noise, at edges every other sample is light.
double edges(std::mt19937_64& random, std::uint32_t x, std::uint32_t y) {
    if (x % 16 == 0) return std::bernoulli_distribution(0.5)(random) ? 1.0 : 0.0;
    return (x / 16 + y / 16) % 2 ? 0.25 : 0.75 * std::uniform_real_distribution<double>(0.0, 2.0)(random);
}

/// The means of `samples` samples of each pixel, with the variance of the mean.
Image render(std::uint64_t seed, const Sampler& sampler, int samples) {
    std::mt19937_64 random(seed);
    const std::size_t pixels = std::size_t(kSize) * kSize;
    std::vector<float> means(pixels), variances(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        double sum = 0.0, squares = 0.0;
        for (int s = 0; s < samples; ++s) {
            const double value =
                sampler(random, static_cast<std::uint32_t>(i % kSize), static_cast<std::uint32_t>(i / kSize));
            sum += value;
            squares += value * value;
        }
        means[i] = static_cast<float>(sum / samples);
        variances[i] = static_cast<float>(std::max(0.0, squares / samples - sum * sum / samples / samples) /
                                          (samples - 1));
    }
    Image image = imageOf(kSize, kSize, {floats("Y", means), floats("variance", variances)});
    image.ints["samplesPerPixel"] = samples;
    return image;
}

NoiseTest testNoise(const Image& a, const Image& b, const Image* second = nullptr) {
    CompareOptions options;
    const Picture c = pictureOf(second ? *second : b);
    options.noise.on = true;
    return *comparePictures(pictureOf(a), pictureOf(b), options, {nullptr, second ? &c : nullptr})
                .comparison.noise;
}

void scaleIn(Image& image, std::uint32_t lo, std::uint32_t hi, float factor) {
    for (std::uint32_t y = lo; y < hi; ++y)
        for (std::uint32_t x = lo; x < hi; ++x)
            image.channels[0].values[std::size_t(y) * kSize + x] *= factor;
}

TEST(NoiseTest, PassesPicturesOfOtherSeedsWhateverTheirNoise) {
    int alarms = 0, runs = 0;
    for (const Sampler& sampler : {Sampler(gaussian), Sampler(fireflies), Sampler(edges)}) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            const Image a = render(100 + seed, sampler, 8), b = render(200 + seed, sampler, 8),
                        c = render(300 + seed, sampler, 8);
            alarms += testNoise(a, b).passed() ? 0 : 1;
            alarms += testNoise(a, b, &c).passed() ? 0 : 1;
            runs += 2;
        }
    }
    EXPECT_EQ(alarms, 0) << "of " << runs << " at a rate of 1e-3";
}

TEST(NoiseTest, CatchesABiasOfOnePerCentInABigRegion) {
    Image a = render(1, gaussian, 64);
    const Image b = render(2, gaussian, 64),
                c = render(3, gaussian, 64); // 10 % of noise, 14 % in the difference
    EXPECT_TRUE(testNoise(a, b).passed());
    scaleIn(a, 32, 224, 1.01f);
    const NoiseTest found = testNoise(a, b);
    EXPECT_FALSE(found.passed());
    ASSERT_GT(found.significantRegionCount, 0u);
    EXPECT_NEAR(found.significantRegions.front().relativeBias, 0.01, 0.006);
    EXPECT_FALSE(testNoise(a, b, &c).passed());
    a.channels.pop_back(); // without variances regions still tell
    EXPECT_FALSE(testNoise(a, imageOf(kSize, kSize, {b.channels[0]})).passed());
}

TEST(NoiseTest, CatchesSinglePixelsThatNoNoiseExplains) {
    Image a = render(4, gaussian, 64);
    const Image b = render(5, gaussian, 64), c = render(6, gaussian, 64);
    a.channels[0].values[5000] += 3.0f;
    const NoiseTest found = testNoise(a, b);
    EXPECT_EQ(found.significantPixels, 1u);
    EXPECT_GT(found.largestZ, 10.0);
    EXPECT_TRUE(testNoise(a, b, &c).passed()) << "one outlier of the usual size may be the seed's";
    for (std::size_t i = 0; i < 30; ++i) a.channels[0].values[1000 + 700 * i] += 3.0f;
    EXPECT_EQ(testNoise(a, b, &c).significantPixels, 31u);
}

TEST(NoiseTest, ASecondSeedTellsWhatIsTooLargeForAnyNoise) {
    for (const Sampler& sampler : {Sampler(gaussian), Sampler(fireflies), Sampler(edges)}) {
        const Image a = render(4, sampler, 64), b = render(5, sampler, 64), c = render(6, sampler, 64);
        ASSERT_TRUE(testNoise(a, b, &c).passed());
        Image pixel = a;
        pixel.channels[0].values[5000] = 1e6f;
        const NoiseTest found = testNoise(pixel, b, &c);
        EXPECT_EQ(found.significantPixels, 0u) << "a single one, of which other seeds may have as many";
        ASSERT_TRUE(found.outlier);
        EXPECT_EQ(found.outlier->x, 5000 % int(kSize));
        EXPECT_EQ(found.outlier->y, 5000 / int(kSize));
        EXPECT_NEAR(found.outlier->difference, 1e6, 100.0);
        EXPECT_LT(found.outlier->usual, 100.0);
        Image blob = a;
        for (std::uint32_t i = 0; i < 25; ++i)
            blob.channels[0].values[(100 + i / 5) * kSize + 100 + i % 5] = 5.0f;
        EXPECT_FALSE(testNoise(blob, b, &c).passed());
    }
}

TEST(NoiseTest, CatchesSmallDifferencesWhereThereIsNoNoise) {
    Image a = render(7, edges, 16);
    const Image b = render(8, edges, 16);
    ASSERT_TRUE(testNoise(a, b).passed());
    a.channels[0].values[8 * kSize + 24] *= 1.001f; // inside a quiet square
    const NoiseTest found = testNoise(a, b);
    EXPECT_EQ(found.significantPixels, 1u);
    scaleIn(a, 0, kSize, 1.01f);
    EXPECT_GT(testNoise(a, b).significantPixels, 1000u);
}

TEST(NoiseTest, PicturesTooSmallToTellDoNotPass) {
    const auto constant = [](std::uint32_t side, float value) {
        return imageOf(side, side, {floats("Y", std::vector<float>(std::size_t(side) * side, value))});
    };
    for (const std::uint32_t side : {1u, 16u, 32u}) {
        EXPECT_FALSE(testNoise(constant(side, 50.0f), constant(side, 1.0f)).passed()) << side;
        EXPECT_FALSE(testNoise(constant(side, 1.1f), constant(side, 1.0f)).passed()) << side;
        EXPECT_TRUE(testNoise(constant(side, 1.0f), constant(side, 1.0f)).passed()) << side;
        EXPECT_TRUE(testNoise(constant(side, 1.0f + 0x1p-20f), constant(side, 1.0f)).passed()) << side;
    }
    EXPECT_FALSE(testNoise(constant(64, 1.1f), constant(64, 1.0f)).passed()) << "which is large enough";
}

TEST(NoiseTest, PicturesThatDifferWithoutKnownNoiseOfPixelsDoNotPass) {
    const Image a = render(14, gaussian, 16), b = render(15, gaussian, 16), c = render(16, gaussian, 16);
    const auto color = [](const Image& image) { return imageOf(kSize, kSize, {image.channels[0]}); };
    const NoiseTest found = testNoise(color(a), color(b));
    EXPECT_EQ(found.untested, std::vector<std::string>{"Y"});
    EXPECT_FALSE(found.passed());
    const Image third = color(c);
    EXPECT_TRUE(testNoise(color(a), color(b), &third).passed());
    EXPECT_TRUE(testNoise(color(a), color(a)).passed()) << "equal ones do";
    Image unknown = a; // variances, but of how many samples?
    unknown.ints.clear();
    EXPECT_FALSE(testNoise(unknown, b).passed());
}

TEST(NoiseTest, CatchesTilesThatAreLostOrMuchTooBright) {
    const Sampler flat = [](std::mt19937_64&, std::uint32_t, std::uint32_t) { return 0.7; };
    for (const Sampler& sampler : {Sampler(gaussian), flat})
        for (const float factor : {0.0f, 50.0f})
            for (const std::uint32_t side : {8u, 16u, 32u}) {
                Image a = render(11, sampler, 64);
                const Image b = render(12, sampler, 64);
                ASSERT_TRUE(testNoise(a, b).passed());
                scaleIn(a, 64, 64 + side, factor);
                a.channels.pop_back(); // no variances
                EXPECT_FALSE(testNoise(a, imageOf(kSize, kSize, {b.channels[0]})).passed())
                    << factor << " in " << side;
            }
}

TEST(NoiseTest, RoundingIsNoDifference) {
    const Sampler flat = [](std::mt19937_64&, std::uint32_t, std::uint32_t) { return 0.7; };
    Image a = render(9, flat, 4);
    const Image b = a;
    scaleIn(a, 0, kSize, 1.0f + 0x1p-20f);
    EXPECT_TRUE(testNoise(a, b).passed());
    scaleIn(a, 0, kSize, 1.0f + 0x1p-10f);
    EXPECT_FALSE(testNoise(a, b).passed());
}

TEST(NoiseTest, OtherNumbersOfSamplesAreKnown) {
    const Image a = render(10, gaussian, 16);
    Image b = render(11, gaussian, 256);
    EXPECT_TRUE(testNoise(a, b).passed());
    b.channels.pop_back(); // its variance follows from the other's
    CompareOptions options;
    options.noise.on = true;
    options.allowed.insert(FindingKind::Channels);
    EXPECT_TRUE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.noise->passed());
    EXPECT_GT(comparePictures(pictureOf(a), pictureOf(b), options).comparison.noise->pixels, 0u);
}

TEST(NoiseTest, TheSameRenderAgainIsNoSecondOne) {
    const Image a = render(20, gaussian, 16), b = render(21, gaussian, 16);
    EXPECT_THROW(testNoise(a, b, &a), Error) << "which would hide all that a single pixel has of faults";
    EXPECT_THROW(testNoise(a, b, &b), Error);
    EXPECT_TRUE(testNoise(b, b, &b).passed()) << "equal pictures have no noise to tell";
}

TEST(NoiseTest, AVarianceThatCannotBeIsCaught) {
    Image a = render(22, gaussian, 16);
    const Image b = render(23, gaussian, 16);
    ASSERT_TRUE(testNoise(a, b).passed());
    for (std::size_t i = 0; i < 10; ++i) a.channels[0].values[i * 97] = 60.0f;
    EXPECT_GT(testNoise(a, b).significantPixels, 0u);
    a.channels[1].values.assign(a.pixelCount(), 1e8f); // in which any pixel may differ
    const NoiseTest found = testNoise(a, b);
    ASSERT_GT(found.significantRegionCount, 0u);
    EXPECT_EQ(found.significantRegions[0].channel, "variance");
}

TEST(NoiseTest, IdsAreComparedAllTheSame) {
    Image a = render(24, gaussian, 16), b = render(25, gaussian, 16);
    a.channels.insert(a.channels.begin() + 1, uints("id", std::vector<std::uint32_t>(a.pixelCount(), 1)));
    b.channels.insert(b.channels.begin() + 1, uints("id", std::vector<std::uint32_t>(b.pixelCount(), 2)));
    CompareOptions options;
    options.noise.on = true;
    EXPECT_FALSE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.passed());
    options.limits = {{Metric::Differing, "id", 0, 1}};
    EXPECT_TRUE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.passed());
}

TEST(NoiseTest, TakesThePlaceOfEqualColorsInTheVerdict) {
    const Image a = render(12, gaussian, 16), b = render(13, gaussian, 16);
    CompareOptions options;
    EXPECT_FALSE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.passed());
    options.noise.on = true;
    EXPECT_TRUE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.passed());
    options.limits.push_back({Metric::Rmse, "", 0.0, 1e-3});
    EXPECT_FALSE(comparePictures(pictureOf(a), pictureOf(b), options).comparison.passed());
}

} // namespace
} // namespace rt::test
