#include "common/error.h"
#include "tests/support/compared_renders.h"
#include "tools/rt-compare/self_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace rt::test {
namespace {

using testing::ElementsAre;

/// "layer: fault" of those that must lead to this, of which all must be judged rightly.
std::vector<std::string> injected(const std::vector<Injection>& injections,
                                  std::optional<FindingKind> expected) {
    std::vector<std::string> names;
    for (const Injection& injection : injections) {
        EXPECT_TRUE(injection.asExpected)
            << injection.layer << ": " << injection.fault << ": " << injection.found;
        if (injection.applies && injection.expected == expected)
            names.push_back(injection.layer + ": " + injection.fault);
    }
    return names;
}

Picture twoParts() {
    Picture two = picture();
    two.parts.push_back(partOf(imageOf(2, 1, {floats("Z", {1, 2})})));
    two.parts[0].name = "beauty";
    two.parts[1].name = "depth";
    return two;
}

TEST(SelfTest, PutsFaultsIntoEveryLayerOfEveryPart) {
    const auto injections = injectFaults(twoParts(), {});
    EXPECT_THAT(injected(injections, FindingKind::Black),
                ElementsAre("beauty/color: black frame", "beauty/Z: black frame", "depth/Z: black frame"));
    EXPECT_THAT(injected(injections, FindingKind::Channels),
                ElementsAre("beauty/color: channel renamed", "beauty/color: channel of zeros added",
                            "beauty/Z: channel renamed", "beauty/id: channel renamed",
                            "depth/Z: channel renamed", "depth/Z: channel of zeros added"));
    EXPECT_THAT(injected(injections, std::nullopt), ElementsAre()) << "all must be equal";
}

TEST(SelfTest, ShowsWhatTheLimitsDoNotHold) {
    CompareOptions options;
    options.limits = {{Metric::Rmse, "", 0, 0.02}, {Metric::Differing, "id", 0, 0.1}};
    const auto injections = injectFaults(picture(), options);
    EXPECT_THAT(injected(injections, std::nullopt),
                ElementsAre("color: error of 1 %", "color: error of 1 ulp", "Z: shift by one pixel",
                            "Z: gamma 2.2 applied", "Z: error of 1 %", "Z: error of 1 ulp",
                            "id: one id changed"));
    const auto found = std::ranges::find(injections, "gamma 2.2 applied", &Injection::fault);
    EXPECT_EQ(std::ranges::find(injections, "Z", &Injection::layer)->expected, FindingKind::NonFinite);
    EXPECT_EQ(found->expected, FindingKind::Limit);
}

TEST(SelfTest, KeepsToWhatIsCompared) {
    CompareOptions options;
    options.region.crop = PixelBox{2, 2, 18, 8};
    options.region.ignored = {{5, 4, 20, 7}};
    options.channels.only = {"color"};
    options.limits = {{Metric::Rmse, "", 0, 0.02}};
    Picture mask = pictureOf(imageOf(20, 10, {floats("Y", std::vector<float>(200, 1.0f))}));
    std::fill_n(mask.parts[0].image.channels[0].values.begin(), 100, 0.0f);
    const auto injections = injectFaults(picture(), options, &mask);
    EXPECT_THAT(injected(injections, FindingKind::NonFinite),
                ElementsAre("color: one NaN", "color: all NaN", "color: one +Inf", "color: one -Inf"));
    EXPECT_THAT(injected(injections, FindingKind::Channels), ElementsAre("color: channel renamed"));
    EXPECT_FALSE(injections.back().applies) << "the added channel is not among those compared";
    options.region.crop = PixelBox{30, 30, 40, 40};
    EXPECT_THROW(injectFaults(picture(), options), Error) << "nothing is compared";
}

TEST(SelfTest, TakesPicturesThatHoldWhatIsNotFinite) {
    Picture odd = picture();
    odd.parts[0].image.channels[0].values[3] = std::numeric_limits<float>::quiet_NaN();
    odd.parts[0].image.channels[3].values[4] = std::numeric_limits<float>::max();
    EXPECT_THROW(injectFaults(odd, {}), Error);
    CompareOptions options;
    options.allowSameNonFinite = true;
    const auto injections = injectFaults(odd, options);
    const auto found = injected(injections, FindingKind::NonFinite);
    EXPECT_NE(std::ranges::find(found, "color: shift by one pixel"), found.end());
    options.allowed = {FindingKind::Black, FindingKind::Channels};
    options.limits = {{Metric::MaxAbs, "*", 0, 1e39}, {Metric::Differing, "*", 0, 1}};
    injected(injectFaults(odd, options), std::nullopt);
}

} // namespace
} // namespace rt::test
