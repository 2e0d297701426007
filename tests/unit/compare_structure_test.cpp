#include "common/error.h"
#include "tests/support/compared_renders.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rt::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ComparePictures, WhatTheCameraIsMustBeTheSame) {
    for (const char* name : {"screenWindowWidth", "screenWindowCenter", "view", "envmap"}) {
        Picture other = picture();
        other.parts[0].camera[name] = std::string("2");
        EXPECT_THAT(failuresOf(other, picture()),
                    ElementsAre(HasSubstr(fmt::format("{} differs: 2 against", name))));
        EXPECT_THAT(failuresOf(other, picture(), allowing(FindingKind::Camera)), IsEmpty());
    }
}

TEST(ComparePictures, SizesThatDifferFailWithoutFigures) {
    const Picture wide = pictureOf(imageOf(4, 1, {floats("R", {1, 1, 1, 1})}));
    const Picture square = pictureOf(imageOf(2, 2, {floats("R", {1, 1, 1, 1})}));
    const Comparison c = compare(wide, square, loose());
    EXPECT_THAT(failures(c), ElementsAre("size: sizes differ: 4 x 1 against 2 x 2"));
    EXPECT_EQ(colorOf(c), nullptr);
    EXPECT_THAT(failuresOf(wide, square, allowing(FindingKind::Size)),
                ElementsAre(HasSubstr("limit: color: RMSE")));
}

TEST(ComparePictures, DataWindowsThatDifferFailAndCountAsZeroOutsideIfAllowed) {
    Picture whole = pictureOf(imageOf(4, 1, {floats("R", {0, 1, 2, 0})}));
    Picture part = pictureOf(imageOf(2, 1, {floats("R", {1, 2})}));
    part.parts[0].displayWindow = {0, 0, 4, 1};
    part.parts[0].dataWindow = {1, 0, 3, 1};
    EXPECT_THAT(failuresOf(whole, part, loose()),
                ElementsAre("data-window: data windows differ: 0,0,4,1 against 1,0,3,1"));
    EXPECT_THAT(failuresOf(whole, part, allowing(FindingKind::DataWindow)), IsEmpty());
    part.parts[0].image.channels[0].values[1] = 2.5f;
    const Comparison c = compare(whole, part, allowing(FindingKind::DataWindow));
    EXPECT_EQ(colorOf(c)->worst[0].x, 2);
    EXPECT_EQ(colorOf(c)->figures.values, 4u);
    whole.parts[0].image.channels[0].values[3] = 9.0f; // outside of the part
    EXPECT_EQ(colorOf(compare(whole, part, allowing(FindingKind::DataWindow)))->figures.maxAbs, 9.0);
    Picture far = part;
    far.parts[0].dataWindow = {1 << 20, 1 << 20, (1 << 20) + 2, (1 << 20) + 1};
    EXPECT_THROW(compare(whole, far, allowing(FindingKind::DataWindow)), Error);
    CompareOptions crop = allowing(FindingKind::DataWindow);
    crop.region.crop = PixelBox{0, 0, 2, 1};
    EXPECT_THAT(failuresOf(whole, part, crop), IsEmpty());
}

TEST(ComparePictures, OtherMetadataFailsByName) {
    Picture other = picture();
    other.parts[0].pixelAspect = 2.0f;
    EXPECT_THAT(failuresOf(picture(), other, loose()),
                ElementsAre("pixel-aspect: pixel aspects differ: 1 against 2"));
    EXPECT_THAT(failuresOf(picture(), other, allowing(FindingKind::PixelAspect)), IsEmpty());
    other = picture();
    other.parts[0].chromaticities = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    EXPECT_THAT(failuresOf(picture(), other, loose()), IsEmpty()) << "these are meant where none are given";
    Picture wide = other;
    (*wide.parts[0].chromaticities)[0] = 0.708f;
    EXPECT_THAT(failuresOf(wide, other, loose()),
                ElementsAre(HasSubstr("chromaticities: chromaticities differ: 0.708")));
    EXPECT_THAT(failuresOf(wide, other, allowing(FindingKind::Chromaticities)), IsEmpty());
    other = picture();
    other.parts[0].image.ints["samplesPerPixel"] = 64;
    const Comparison c = compare(picture(), other);
    EXPECT_TRUE(c.passed());
    EXPECT_THAT(c.notes, ElementsAre("samples per pixel: 16 against 64"));
}

TEST(ComparePictures, ChannelsOfOtherKindsFail) {
    Image retyped = render();
    retyped.channels[4] = floats("id", std::vector<float>(200));
    EXPECT_THAT(failuresOf(picture(), pictureOf(retyped), loose()),
                ElementsAre("channels: channel id is uint against number"));
    Image half = render();
    for (std::size_t c = 0; c < 4; ++c) half.channels[c].type = ImageChannel::Type::Half;
    EXPECT_THAT(failuresOf(picture(), pictureOf(half)), IsEmpty()) << "values count, not how they are stored";
}

TEST(ComparePictures, LinearLightAgainstDisplayValuesFailsUnlessItIsDecoded) {
    Picture linear = pictureOf(imageOf(2, 1, {floats("A", {0.5f, 1}), floats("R", {0.21404114f, 1})}));
    Picture display = pictureOf(imageOf(2, 1, {floats("A", {0.5f, 1}), floats("R", {0.5f, 1})}));
    display.scale = ValueScale::Display;
    display.format = "PNG, 8 bits";
    EXPECT_THAT(
        failuresOf(linear, display, loose()),
        ElementsAre("encoding: encodings differ: EXR holds linear light, PNG, 8 bits display values"));
    CompareOptions options = allowing(FindingKind::Encoding);
    options.limits = {{Metric::MaxAbs, "", 0, 1e-6}};
    EXPECT_THAT(failuresOf(linear, display, options), IsEmpty());
}

TEST(ComparePictures, PartsAreMatchedByName) {
    Picture a = picture(), b;
    a.parts.push_back(partOf(imageOf(1, 1, {floats("Z", {5})})));
    a.parts[0].name = "beauty";
    a.parts[1].name = "depth";
    b = a;
    std::swap(b.parts[0], b.parts[1]);
    EXPECT_THAT(failuresOf(a, b), IsEmpty());
    b.parts[0].name = "other";
    EXPECT_THAT(failuresOf(a, b, loose()), ElementsAre("parts: part depth is in the first image only",
                                                       "parts: part other is in the second image only"));
}

TEST(ComparePictures, LayersAreGroupedByTheirNames) {
    const Image image = imageOf(1, 1,
                                {floats("A", {1}), floats("B", {1}), floats("G", {1}), floats("N.X", {1}),
                                 floats("N.Y", {1}), floats("N.Z", {1}), floats("R", {1}), floats("Z", {1}),
                                 floats("albedo.B", {1}), floats("albedo.G", {1}), floats("albedo.R", {1}),
                                 floats("albedo.Z", {1}), uints("id", {1})});
    std::vector<std::string> names;
    for (const LayerComparison& layer : compare(pictureOf(image), pictureOf(image)).layers) {
        names.push_back(layer.name + ":");
        for (const ChannelComparison& channel : layer.channels) names.back() += " " + channel.name;
    }
    EXPECT_THAT(names, ElementsAre("color: R G B A", "albedo: albedo.R albedo.G albedo.B", "N: N.X N.Y N.Z",
                                   "Z: Z", "albedo.Z: albedo.Z", "id: id"));
}

} // namespace
} // namespace rt::test
