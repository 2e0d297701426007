#include "tools/rt-compare/compare.h"

#include "tools/rt-compare/alignment.h"
#include "tools/rt-compare/layers.h"
#include "tools/rt-compare/non_finite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

// In which of the pictures the chosen channels are black: nowhere above a millionth of what the other picture
// has in the mean, which a few pixels without measure do not move much.
struct Blackness {
    bool a = false, b = false;
    bool differs() const { return a != b; }
};

Blackness blacknessOf(const LayerComparison& layer, bool ofOpacity) {
    constexpr double kBlack = 1e-6;
    struct Values {
        double largest = 0.0, mean = 0.0;
        void add(const ValueRange& range) {
            const double magnitude = std::max(std::abs(range.min), std::abs(range.max));
            largest = std::isnan(magnitude) ? HUGE_VAL : std::max(largest, magnitude); // NaN is not black
            mean = std::max(mean, std::abs(range.mean));
        }
        bool isBlackBeside(const Values& other) const {
            return (largest == 0.0 && other.largest > 0.0) || largest < kBlack * other.mean;
        }
    } a, b;
    for (const ChannelComparison& channel : layer.channels) {
        const bool isOpacity =
            layer.kind == LayerKind::Color && splitChannelName(channel.name).last.ends_with("A");
        if (isOpacity != ofOpacity) continue;
        a.add(channel.figures.a);
        b.add(channel.figures.b);
    }
    return {a.isBlackBeside(b), b.isBlackBeside(a)};
}

// A loose limit may let a black picture pass where little is to be seen; it is never what was wanted.
void findBlack(const AllowedKinds& allowed, Comparison& comparison) {
    const auto add = [&](const LayerComparison& layer, const Blackness& black, const char* what) {
        if (!black.differs()) return;
        comparison.findings.push_back(
            {FindingKind::Black,
             fmt::format("{}: the {} image is {} everywhere, the {} is not", layer.name,
                         black.a ? "first" : "second", what, black.a ? "second" : "first"),
             !allowed.contains(FindingKind::Black)});
    };
    for (const LayerComparison& layer : comparison.layers) {
        if (layer.kind == LayerKind::Ids) continue;
        add(layer, blacknessOf(layer, false), layer.kind == LayerKind::Color ? "black" : "0");
        add(layer, blacknessOf(layer, true), "transparent");
    }
}

// Whether some limit holds the layer or a channel of it.
bool isGated(const LayerComparison& layer, const Comparison& comparison) {
    return std::ranges::any_of(comparison.checks, [&](const LimitCheck& check) {
        return check.where == layer.name ||
               std::ranges::find(layer.channels, check.where, &ChannelComparison::name) !=
                   layer.channels.end();
    });
}

// Layers that no limit and no noise test holds and that differ should not go unseen.
void noteUngated(Comparison& comparison) {
    std::vector<std::string> names;
    for (const LayerComparison& layer : comparison.layers) {
        if (comparison.noise && layer.kind != LayerKind::Ids) continue;
        const bool differs = !layer.figures.over.empty() && layer.figures.over.front().pixels > 0;
        if (differs && !isGated(layer, comparison)) names.push_back(layer.name);
    }
    if (!names.empty())
        comparison.notes.push_back(fmt::format(
            "no limit holds {}, which differ; --max-rmse NAME=X sets one, --max-differing NAME=F of "
            "uint channels",
            fmt::join(names, ", ")));
}

// A name that is mistyped would leave out more, or less, than was meant.
void findUnknownNames(const Picture& a, const Picture& b, const ChannelSelection& selection,
                      Comparison& comparison) {
    for (const std::string& name : unknownNames(a, b, selection.only))
        comparison.findings.push_back(
            {FindingKind::Nothing,
             fmt::format("no channel or layer is called {}, which --channels names", name)});
    for (const std::string& name : unknownNames(a, b, selection.without))
        comparison.notes.push_back(
            fmt::format("no channel or layer is called {}, which --ignore-channels names", name));
}

// Limits of colors alone, where there are no colors, hold nothing: ids and such would pass for a picture.
void findIdleLimits(const CompareOptions& options, Comparison& comparison) {
    const auto isColor = [](const LayerComparison& layer) { return layer.kind == LayerKind::Color; };
    if (options.noise.on || std::ranges::any_of(comparison.layers, isColor)) return;
    for (const LayerComparison& layer : comparison.layers)
        if (!isGated(layer, comparison)) {
            comparison.findings.push_back(
                {FindingKind::Nothing,
                 fmt::format("no limit holds {}, for there are no colors: --max-rmse {}=X sets one",
                             layer.name, layer.name)});
            return;
        }
}

void addNoiseFindings(Comparison& comparison) {
    if (!comparison.noise || comparison.noise->passed()) return;
    const NoiseTest& noise = *comparison.noise;
    if (!noise.tooSmall.empty())
        comparison.findings.push_back(
            {FindingKind::Noise,
             fmt::format("{} differ, in too few pixels to tell that from noise; compare them with limits "
                         "instead",
                         fmt::join(noise.tooSmall, ", "))});
    if (!noise.untested.empty())
        comparison.findings.push_back(
            {FindingKind::Noise,
             fmt::format("{} differ, and the noise of single pixels is not known ({}); render both with "
                         "--aov Z,N,id,variance, give --second-seed, or compare with limits instead",
                         fmt::join(noise.untested, ", "), noise.source)});
    if (noise.outlier)
        comparison.findings.push_back(
            {FindingKind::Noise,
             fmt::format("around x {}, y {} the luminance is {:.6g} from both other renders, which differ "
                         "so from two others by {:.6g} at most",
                         noise.outlier->x, noise.outlier->y, noise.outlier->difference,
                         noise.outlier->usual)});
    if (noise.significantPixels > 0)
        comparison.findings.push_back(
            {FindingKind::Noise,
             fmt::format("{} of {} pixels differ by more than their noise, the largest by "
                         "{:.3g} standard deviations",
                         noise.significantPixels, noise.pixels, noise.largestZ)});
    if (noise.significantRegionCount > 0) {
        const NoiseTest::Region& worst = noise.significantRegions.front();
        comparison.findings.push_back(
            {FindingKind::Noise,
             fmt::format(
                 "{} of {} regions differ by more than their noise; {} at {},{},{},{} by {:.3g} ({:.3g} %), "
                 "which noise does with a probability of {:.1e}",
                 noise.significantRegionCount, noise.regions, worst.channel, worst.box.x0, worst.box.y0,
                 worst.box.x1, worst.box.y1, worst.bias, 100.0 * worst.relativeBias, worst.probability)});
    }
}

void noteSamples(const PreparedPair& pair, Comparison& comparison) {
    const auto samplesOf = [](const Picture& picture) {
        const std::optional<int> samples = samplesPerPixel(picture);
        return samples ? std::to_string(*samples) : std::string("unknown");
    };
    const std::string a = samplesOf(pair.a), b = samplesOf(pair.b);
    if (a != b) comparison.notes.push_back(fmt::format("samples per pixel: {} against {}", a, b));
}

} // namespace

PairResult comparePictures(Picture&& a, Picture&& b, const CompareOptions& options,
                           const SidePictures& side) {
    PairResult result;
    Comparison& comparison = result.comparison;
    findUnknownNames(a, b, options.channels, comparison);
    const PreparedPair& pair =
        result.pair.emplace(preparePair(std::move(a), std::move(b), options, side.mask, comparison.findings));
    comparison.scale = pair.a.scale;
    if (!pair.regions.empty()) comparison.box = pair.regions.front().box;
    for (const ComparedRegion& region : pair.regions) comparison.ignored += region.ignoredCount;
    findNonFinite(pair, options.allowSameNonFinite, comparison);
    noteSamples(pair, comparison);
    for (const LayerPair& layer : pair.layers)
        comparison.layers.push_back(measureLayer(layer, pair.regions[layer.part], options.metrics));
    result.maps = addPerception(pair, options.perception, comparison);
    if (pair.layers.empty() && comparison.passed())
        comparison.findings.push_back({FindingKind::Nothing, "the images have no channel in common"});
    findBlack(options.allowed, comparison);
    if (options.noise.on) comparison.noise = testNoise(pair, options.noise, side.second);
    addNoiseFindings(comparison);
    checkLimits(options.limits, options.noise.on, comparison);
    findIdleLimits(options, comparison);
    noteUngated(comparison);
    if (options.maxShift > 0) comparison.alignment = findAlignment(pair, comparison, options.maxShift);
    result.exitCode = comparison.passed() ? 0 : kExitImagesDiffer;
    return result;
}

} // namespace rt
