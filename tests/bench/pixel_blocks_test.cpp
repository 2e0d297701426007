#include "tests/bench/pixel_blocks.h"

#include "common/error.h"

#include <gtest/gtest.h>

namespace rt::bench {
namespace {

using Type = ImageChannel::Type;

// 4 x 2 pixels.
const Image kImage{4,
                   2,
                   {},
                   {{"R", Type::Float, {0, 1, 10, 20, 2, 3, 30, 40}, {}},
                    {"Z", Type::Float, {1, 1, 1, 1, 1, 1, 1, 1}, {}},
                    {"id", Type::Uint, {}, {0, 1, 2, 3, 4, 5, 6, 7}}},
                   {},
                   {},
                   {},
                   {}};

TEST(PixelBlocks, AreAveragedByColour) {
    const Image small = averageBlocks(kImage, 2, "x.exr");
    EXPECT_EQ(small.width, 2u);
    EXPECT_EQ(small.height, 1u);
    ASSERT_EQ(small.channels.size(), 1u) << "depth and triangle have no mean";
    EXPECT_EQ(small.channels[0].name, "R");
    EXPECT_EQ(small.channels[0].values, (std::vector<float>{1.5f, 25.0f}));
}

TEST(PixelBlocks, OfOnePixelAreThePixels) {
    EXPECT_EQ(averageBlocks(kImage, 1, "x.exr").channels[0].values, kImage.channels[0].values);
}

TEST(PixelBlocks, ThatDoNotFillTheImageAreAnError) {
    EXPECT_THROW(averageBlocks(kImage, 3, "x.exr"), Error);
    EXPECT_THROW(averageBlocks(kImage, 4, "x.exr"), Error);
    Image colourless = kImage;
    colourless.channels.erase(colourless.channels.begin());
    EXPECT_THROW(averageBlocks(colourless, 1, "x.exr"), Error);
}

} // namespace
} // namespace rt::bench
