#pragma once
#include "formats/picture.h"
#include "tools/rt-compare/finding.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// What a comparison finds out: plain figures, computed once, for every report. `a` is the picture under
/// test, `b` the reference. Figures that could not be computed are NaN. All are in the pictures' own units:
/// linear light, or display values from 0 to 1 (see Comparison::scale). Positions are absolute: those of the
/// data window, not of the crop.
namespace rt {

inline constexpr double kNotComputed = std::numeric_limits<double>::quiet_NaN();

struct PixelValue {
    std::string channel;
    std::int32_t x = 0, y = 0;
    double value = 0.0;
};

/// Counts of values, and of the pixels that hold any of them.
struct NonFiniteCounts {
    std::uint64_t nan = 0, positiveInf = 0, negativeInf = 0;
    std::uint64_t pixels = 0;
    std::optional<PixelValue> first; ///< in the order of parts, channels, rows
    std::uint64_t total() const { return nan + positiveInf + negativeInf; }
};

/// A place that holds NaN or an infinity in one of the pictures or in both.
struct NonFinitePlace {
    std::string channel;
    std::int32_t x = 0, y = 0;
    double a = 0.0, b = 0.0;
};

struct Percentile {
    double percent = 0.0;
    double absError = 0.0; ///< so many per cent of the values differ by at most this; single precision
};

struct OverThreshold {
    double threshold = 0.0;
    std::uint64_t pixels = 0; ///< in which any value differs by more than the threshold or is not finite
    double fraction = 0.0;    ///< of the pixels compared
};

/// How many values differ by how much: bin 0 counts equal values; bin i >= 1 those whose |a-b| is in
/// [2^(i-1+kLowestExponent), 2^(i+kLowestExponent)), the first and last of them all that lies beyond.
struct ErrorHistogram {
    static constexpr int kLowestExponent = -32;
    static constexpr std::size_t kBins = 65;
    std::array<std::uint64_t, kBins> counts{};
};

/// Extremes and mean of the values of one picture that are finite.
struct ValueRange {
    double min = kNotComputed, max = kNotComputed, mean = kNotComputed;
};

/// Errors of a set of values, over those that are finite in both pictures.
struct ErrorFigures {
    std::uint64_t values = 0;   ///< of the set: not masked
    std::uint64_t compared = 0; ///< of them, finite in both pictures
    double maxAbs = kNotComputed;
    double bias = kNotComputed;   ///< mean of a - b
    double mae = kNotComputed;    ///< mean of |a - b|
    double mse = kNotComputed;    ///< mean of (a - b)^2
    double rmse = kNotComputed;   ///< root of mse
    double relMse = kNotComputed; ///< mean of (a - b)^2 / (b^2 + 0.01)
    double smape = kNotComputed;  ///< mean of |a - b| / (|a| + |b| + 0.01), 0 to 1
    double psnr = kNotComputed;   ///< 10 log10(peak^2 / mse) in dB; infinite where mse is 0
    ValueRange a, b;
    std::vector<Percentile> percentiles; ///< ascending
    std::vector<OverThreshold> over;     ///< ascending; the first is threshold 0: pixels that differ at all
    ErrorHistogram histogram;
};

struct WorstPixel {
    std::string channel; ///< whose values are shown: the one that differs most
    std::int32_t x = 0, y = 0;
    double a = 0.0, b = 0.0;
};

/// FLIP of a color layer; the reference is `b`. Source: Andersson et al. 2020 (LDR), 2021 (HDR).
struct FlipFigures {
    bool hdr = false;
    double pixelsPerDegree = 0.0;
    double mean = kNotComputed, min = kNotComputed, max = kNotComputed;
    double weightedMedian = kNotComputed, firstQuartile = kNotComputed, thirdQuartile = kNotComputed;
    std::vector<Percentile> percentiles; ///< of the errors by their number, ascending
    double startExposure = kNotComputed, stopExposure = kNotComputed; ///< HDR only, in stops
    int exposures = 0;                                                ///< HDR only
    std::string note; ///< why automatic exposures were replaced; empty where they were not
};

enum class LayerKind {
    Color, ///< R, G, B, A or Y of a layer
    Data,  ///< other numbers: Z, N.X, ...
    Ids,   ///< uint: compared exactly
};

struct ChannelComparison {
    std::string name;            ///< as the file says, "N.X"; "part/N.X" where the file has several parts
    ErrorFigures figures;        ///< numbers
    std::uint64_t differing = 0; ///< uint: pixels whose values differ
};

/// The channels that belong together: R, G, B and A of the picture ("color") or of a layer ("albedo"), the
/// other channels of a layer ("N"), or one other channel ("Z", "id").
struct LayerComparison {
    std::size_t part = 0; ///< index in the first picture
    std::string name;     ///< "color", "Z", "albedo"; "part/Z" where the file has several parts
    LayerKind kind = LayerKind::Color;
    ErrorFigures figures; ///< over all its channels; for uint only `values`, `compared` and `over` at 0
    std::vector<ChannelComparison> channels;
    std::vector<WorstPixel> worst; ///< largest difference first; pixels that do not differ are left out
    std::optional<double> ssim, msSsim;
    std::optional<FlipFigures> flip;
};

/// What a limit can be set on. Over: the fraction of pixels that differ by more than a threshold; Differing:
/// that differ at all.
enum class Metric {
    MaxAbs,
    Mae,
    Mse,
    Rmse,
    RelMse,
    Smape,
    Percentile,
    Over,
    Differing,
    Flip,
    Psnr,
    Ssim,
    MsSsim
};

/// What a figure may be at most, or of PSNR, SSIM and MS-SSIM at least.
struct Limit {
    Metric metric = Metric::Rmse;
    std::string where;      ///< a layer or channel; "*": every layer; empty: every color layer
    double parameter = 0.0; ///< Percentile: per cent; Over: threshold
    double value = 0.0;
};

/// One limit, and what was found.
struct LimitCheck {
    Limit limit;
    std::string where; ///< the layer's or channel's name
    double value = kNotComputed;
    bool passed = false; ///< never if the value is NaN
};

/// The best whole-pixel shift of the reference: b(x + dx, y + dy) is like a(x, y).
struct Alignment {
    int dx = 0, dy = 0;
    double rmse = kNotComputed;        ///< of the first color layer, over what both pictures show then
    double rmseInPlace = kNotComputed; ///< of the same pixels without the shift
    bool shifted() const { return dx != 0 || dy != 0; }
};

/// Whether the pictures differ by more than their noise. See noise_test.h.
struct NoiseTest {
    std::string source;       ///< where the noise is known from
    double level = 0.0;       ///< probability of a false alarm
    std::uint64_t pixels = 0; ///< tested
    std::uint64_t significantPixels = 0;
    double largestZ = 0.0;
    std::uint64_t regions = 0; ///< tested, of all sizes, layers and channels
    struct Region {
        std::string channel;
        PixelBox box;
        double bias = 0.0, relativeBias = 0.0; ///< mean of a - b; over the mean of b
        double probability = 1.0;              ///< of such a difference by noise, before correction
    };
    std::vector<Region> significantRegions; ///< least probable first, at most 10
    std::uint64_t significantRegionCount = 0;
    std::vector<std::string> tooSmall; ///< channels that differ, of too few pixels to tell that from noise
    std::vector<std::string> untested; ///< channels that differ where no single pixel could be tested
    struct Outlier {
        std::int32_t x = 0, y = 0;
        double difference = 0.0, usual = 0.0; ///< least of luminance to the other two renders; theirs at most
    };
    std::optional<Outlier> outlier; ///< that is too large for the noise of a second seed's render
    bool passed() const {
        return significantPixels == 0 && significantRegionCount == 0 && tooSmall.empty() &&
               untested.empty() && !outlier;
    }
};

/// What was found out about two pictures.
struct Comparison {
    ValueScale scale = ValueScale::Linear;
    PixelBox box;              ///< of the first part: what was compared
    std::uint64_t ignored = 0; ///< pixels in the boxes of all parts that a mask or rectangle took out
    NonFiniteCounts nonFiniteA, nonFiniteB;
    std::uint64_t nonFiniteDiffering =
        0; ///< values that are not finite in one picture and not so in the other
    std::vector<NonFinitePlace> nonFinitePlaces; ///< the first ones
    std::vector<LayerComparison> layers;         ///< empty if the pictures could not be compared
    std::vector<LimitCheck> checks;
    std::optional<Alignment> alignment; ///< absent: not looked for, since nothing differs or it is off
    std::optional<NoiseTest> noise;
    std::vector<Finding> findings;
    std::vector<std::string> notes; ///< what moves no verdict but should be known

    bool passed() const {
        for (const Finding& finding : findings)
            if (finding.fails) return false;
        return true;
    }
};

} // namespace rt
