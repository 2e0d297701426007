#include "tests/support/compared_renders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rt::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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
    options.allowed.insert(FindingKind::Black);
    EXPECT_THAT(failuresOf(pictureOf(black), pictureOf(dim), options), IsEmpty());
}

TEST(FalsePass, OpacityThatIsLostWithinALooseLimit) {
    const auto withOpacity = [](float a) {
        return pictureOf(imageOf(2, 1, {floats("A", {a, a}), floats("R", {0.5f, 1})}));
    };
    EXPECT_THAT(failuresOf(withOpacity(0), withOpacity(1), loose()),
                ElementsAre("black: color: the first image is transparent everywhere, the second is not"));
    EXPECT_THAT(failuresOf(withOpacity(0), withOpacity(0), loose()), IsEmpty());
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
    EXPECT_THAT(failuresOf(picture(), pictureOf(moved), allowing(FindingKind::Camera)), IsEmpty());
}

TEST(FalsePass, DepthAndIdsThatNobodyLookedAt) {
    EXPECT_THAT(failuresOf(picture(), withValue(3, 60, 11.5f)), ElementsAre(HasSubstr("limit: Z: RMSE")));
    Image image = render();
    image.channels[4].uints[0] = 99;
    EXPECT_THAT(failuresOf(picture(), pictureOf(image)),
                ElementsAre("limit: id: fraction of pixels that differ 0.005 exceeds 0"));
}

} // namespace
} // namespace rt::test
