#pragma once
#include "formats/image.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// The channels that the verdict's RMSE is taken over, where both images have them.
inline constexpr std::array<const char*, 4> kColorChannels{"R", "G", "B", "A"};

struct PixelValue {
    std::string channel;
    std::uint32_t x = 0, y = 0; ///< from the left, from the top
    double value = 0.0;
};

/// Counts of values over all half and float channels of one image, and of the pixels that hold any of them.
struct NonFiniteCounts {
    std::uint64_t nan = 0, positiveInf = 0, negativeInf = 0;
    std::uint64_t pixels = 0;
    std::optional<PixelValue> first; ///< first in the order of channels, then rows
    std::uint64_t total() const { return nan + positiveInf + negativeInf; }
};

/// Errors of a set of values, over those that are finite in both images; all in the images' own (linear)
/// units.
struct ErrorSums {
    std::uint64_t values = 0;   ///< of the set
    std::uint64_t compared = 0; ///< of them, finite in both images
    double squaredSum = 0.0;
    double maxAbs = 0.0;
    /// Root of the mean squared difference; NaN if nothing was compared.
    double rmse() const;
    void add(const ErrorSums& other);
};

struct ChannelErrors {
    std::string name;
    ErrorSums sums;
};

struct WorstPixel {
    std::string channel;
    std::uint32_t x = 0, y = 0;
    double a = 0.0, b = 0.0;
};

struct UintDifference {
    std::string name;
    std::uint64_t pixels = 0; ///< pixels whose values differ
};

struct Comparison {
    NonFiniteCounts nonFiniteA, nonFiniteB;
    /// The rest is empty if the images differ in size.
    std::vector<ChannelErrors> channels; ///< half and float channels of both images, by name
    std::vector<UintDifference> uints;   ///< uint channels of both images, by name
    std::optional<ErrorSums> color;      ///< over kColorChannels; none if the images share none of them
    std::optional<WorstPixel> worst;     ///< of the color channels; none if they do not differ
    std::vector<std::string> failures;   ///< why the images differ; empty = pass
    bool passed() const { return failures.empty(); }
};

NonFiniteCounts countNonFinite(const Image& image);

/// Errors between two channels of equal size, neither of them uint.
ErrorSums compareValues(const ImageChannel& a, const ImageChannel& b);

/// Passes only images of the same size and the same channels (names, and numbers against uint), all finite,
/// with a color channel in common and an RMSE over the color channels of at most `maxRmse`.
Comparison compareImages(const Image& a, const Image& b, double maxRmse);

} // namespace rt
