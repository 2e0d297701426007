#include "common/error.h"
#include "tests/support/compared_renders.h"
#include "tests/support/split_mix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rt::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(CompareRegion, CropsIgnoredRectanglesAndMasksHideWhatTheyShould) {
    const Picture other = withValue(2, 3 * 20 + 7, kNan); // x 7, y 3
    CompareOptions options;
    options.region.crop = PixelBox{0, 0, 7, 10};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.region.crop = PixelBox{7, 3, 8, 4};
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("first in R at x 7, y 3")));
    options.region.crop.reset();
    options.region.ignored = {{7, 3, 8, 4}};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    EXPECT_EQ(compare(picture(), other, options).ignored, 1u);
    options.region.ignored = {{0, 0, 7, 10}, {8, 0, 20, 10}};
    EXPECT_THAT(failuresOf(picture(), other, options), Contains(HasSubstr("non-finite")));
    Picture mask = pictureOf(imageOf(20, 10, {floats("Y", std::vector<float>(200, 1.0f))}));
    options.region.ignored.clear();
    EXPECT_THAT(failuresOf(picture(), other, options, {&mask}), Contains(HasSubstr("non-finite")));
    mask.parts[0].image.channels[0].values[3 * 20 + 7] = 0.0f;
    EXPECT_THAT(failuresOf(picture(), other, options, {&mask}), IsEmpty());
    options.region.crop = PixelBox{5, 2, 15, 8}; // the mask stays where it is
    EXPECT_THAT(failuresOf(picture(), other, options, {&mask}), IsEmpty());
}

TEST(CompareRegion, NothingLeftIsNoPass) {
    CompareOptions options;
    options.region.crop = PixelBox{100, 100, 110, 110};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("nothing: no pixel is left")));
    options.region.crop.reset();
    options.region.ignored = {{-5, -5, 50, 50}};
    EXPECT_THAT(failuresOf(picture(), picture(), options),
                ElementsAre(HasSubstr("nothing: no pixel is left")));
}

TEST(CompareRegion, MasksThatDoNotFitAreRefused) {
    const Picture small = pictureOf(imageOf(1, 1, {floats("Y", {1})}));
    EXPECT_THROW(compare(picture(), picture(), {}, {&small}), Error);
    const Picture broken = pictureOf(imageOf(20, 10, {floats("Y", std::vector<float>(200, kNan))}));
    EXPECT_THROW(compare(picture(), picture(), {}, {&broken}), Error);
}

TEST(CompareRegion, ChannelsMayBeChosenOrLeftOut) {
    const Picture other = withValue(3, 0, kNan);
    CompareOptions options;
    options.channels.only = {"color", "id"};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.channels.only.clear();
    options.channels.without = {"Z"};
    EXPECT_THAT(failuresOf(picture(), other, options), IsEmpty());
    options.channels.without = {"id"};
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
