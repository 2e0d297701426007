#include "common/progress.h"
#include "tools/rt-trace/render_loop.h"
#include "tools/rt-trace/tile_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rt {
namespace {

// Every way to cut the work visits each pixel of the window once per sample, and no other pixel.
TEST(TileSamples, RegionsCoverTheWindowOnce) {
    const glm::uvec4 window(10, 33, 200, 131);
    for (const std::uint64_t mostPixels : {1ull, 3000ull, 20000ull, 1ull << 40}) {
        TileSamples tiles(window, 3);
        std::vector<unsigned> visits(256 * 256, 0);
        while (const auto round = tiles.nextRound()) {
            EXPECT_EQ(round->most, 3 - round->samples);
            while (const auto region = tiles.next(round->samples, mostPixels)) {
                EXPECT_EQ(region->samples, round->samples);
                EXPECT_LE(region->pixelCount(), std::max<std::uint64_t>(mostPixels, 32 * 32));
                for (unsigned y = region->pixels.y; y < region->pixels.w; ++y)
                    for (unsigned x = region->pixels.x; x < region->pixels.z; ++x) ++visits[y * 256 + x];
                tiles.add(*region, 1);
            }
        }
        for (unsigned y = 0; y < 256; ++y)
            for (unsigned x = 0; x < 256; ++x) {
                const bool inside = x >= 10 && x < 200 && y >= 33 && y < 131;
                ASSERT_EQ(visits[y * 256 + x], inside ? 3u : 0u) << x << "," << y;
            }
        EXPECT_FALSE(tiles.nextRound());
        EXPECT_EQ(tiles.perPixel(), std::vector<std::uint32_t>(190 * 98, 3));
    }
}

TEST(TileSamples, OneRegionIsEnoughForTheWholePicture) {
    const TileSamples tiles({0, 0, 1000, 700}, 1);
    EXPECT_EQ(tiles.next(0, 1u << 30)->pixels, glm::uvec4(0, 0, 1000, 700));
}

TEST(TileSamples, FinishedTilesAreLeftOutAndOthersCatchUp) {
    TileSamples tiles({0, 0, 96, 32}, 10);
    tiles.tiles()[1] = {4, 4}; // finished
    tiles.tiles()[2] = {6, 10};
    const auto round = tiles.nextRound();
    ASSERT_TRUE(round);
    EXPECT_EQ(round->samples, 0u);
    EXPECT_EQ(round->most, 6u); // then as far as the last tile
    const auto region = tiles.next(0, 1u << 30);
    ASSERT_TRUE(region);
    EXPECT_EQ(region->pixels, glm::uvec4(0, 0, 32, 32));
    tiles.add(*region, 6);
    EXPECT_FALSE(tiles.next(0, 1u << 30));
    EXPECT_EQ(tiles.nextRound()->samples, 6u);
    EXPECT_EQ(tiles.unfinishedPixels(), 2u * 32 * 32);
    EXPECT_EQ(tiles.least(), 4u);
    EXPECT_EQ(tiles.most(), 6u);
    EXPECT_DOUBLE_EQ(tiles.mean(), 16.0 / 3.0);
}

TEST(MeanRelativeError, IsThatOfTheMean) {
    // 1 and 3, twice each: mean 2, variance of the samples 4/3, of the mean 1/3.
    const std::vector<glm::vec2> one = {{20.0f, 8.0f}};
    EXPECT_NEAR(meanRelativeError(one, 4), std::sqrt(1.0 / 3.0) / 2.0, 1e-7);
    const std::vector<glm::vec2> two = {{20.0f, 8.0f}, {4.0f, 4.0f}}; // the second is 1 each time
    EXPECT_NEAR(meanRelativeError(two, 4), std::sqrt(1.0 / 3.0) / 4.0, 1e-7);
    const std::vector<glm::vec2> dark = {{0.0f, 0.0f}};
    EXPECT_EQ(meanRelativeError(dark, 4), 0.0);
    const std::vector<glm::vec2> broken = {{NAN, 1.0f}};
    EXPECT_FALSE(meanRelativeError(broken, 4) <= 1.0) << "not finite is not good enough";
}

TEST(Progress, TextSaysHowFarHowFastAndHowLong) {
    EXPECT_EQ(progressText("samples", 43.9, 100.0, 0.0), "43 %");
    EXPECT_EQ(progressText("samples", 50e6, 100e6, 12.5e6), "50 %, 12.5 M samples/s, 4 s left");
    EXPECT_EQ(progressText("samples", 100, 100, 1234), "100 %, 1.2 k samples/s, 0 ms left");
    EXPECT_EQ(progressText("", 0.5, 1.0, 0.25), "50 %, 2 s left");
    EXPECT_EQ(durationText(0.25), "250 ms");
    EXPECT_EQ(durationText(80.0), "1 min 20 s");
    EXPECT_EQ(durationText(3 * 3600 + 5 * 60), "3 h 05 min");
}

} // namespace
} // namespace rt
