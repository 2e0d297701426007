#pragma once
#include "tests/support/compared_layers.h"
#include "tests/support/test_pictures.h"
#include "tools/rt-compare/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace rt::test {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// "kind: text" of all findings that fail.
inline std::vector<std::string> failures(const Comparison& comparison) {
    std::vector<std::string> texts;
    for (const Finding& finding : comparison.findings)
        if (finding.fails) texts.push_back(std::string(traitsOf(finding.kind).name) + ": " + finding.text);
    EXPECT_EQ(texts.empty(), comparison.passed());
    return texts;
}

inline Comparison compare(const Picture& a, const Picture& b, const CompareOptions& options = {},
                          const SidePictures& side = {}) {
    return comparePictures(Picture(a), Picture(b), options, side).comparison;
}
inline std::vector<std::string> failuresOf(const Picture& a, const Picture& b,
                                           const CompareOptions& options = {},
                                           const SidePictures& side = {}) {
    return failures(compare(a, b, options, side));
}

inline CompareOptions allowing(FindingKind kind) {
    CompareOptions options;
    options.allowed.insert(kind);
    return options;
}

/// Limits so loose that only what is no matter of degree fails.
inline CompareOptions loose() {
    CompareOptions options;
    options.limits.push_back({Metric::Rmse, "*", 0.0, 1e30});
    options.limits.push_back({Metric::Differing, "*", 0.0, 1.0});
    return options;
}

/// 20x10 pixels of colors, depth and ids.
inline Image render() {
    Image image = imageOf(20, 10,
                          {floats("B", std::vector<float>(200)), floats("G", std::vector<float>(200)),
                           floats("R", std::vector<float>(200)), floats("Z", std::vector<float>(200)),
                           uints("id", std::vector<std::uint32_t>(200))});
    for (std::size_t i = 0; i < 200; ++i) {
        const float v = 0.5f + 0.5f * std::sin(static_cast<float>(i * i % 97));
        image.channels[0].values[i] = v;
        image.channels[1].values[i] = 0.5f * v;
        image.channels[2].values[i] = 1.0f - v;
        image.channels[3].values[i] = 10.0f + v;
        image.channels[4].uints[i] = static_cast<std::uint32_t>(i / 7);
    }
    image.ints["samplesPerPixel"] = 16;
    image.matrices["worldToCamera"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    return image;
}
inline Picture picture() {
    return pictureOf(render());
}
inline Picture withValue(std::size_t channel, std::size_t pixel, float value) {
    Image image = render();
    image.channels[channel].values[pixel] = value;
    return pictureOf(image);
}

} // namespace rt::test
