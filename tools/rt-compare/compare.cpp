#include "tools/rt-compare/compare.h"

#include "tools/rt-compare/alignment.h"
#include "tools/rt-compare/layers.h"
#include "tools/rt-compare/non_finite.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

bool isZero(const ValueRange& range) {
    return range.min == 0.0 && range.max == 0.0;
}

// A loose limit may let a black picture pass where little is to be seen; it is never what was wanted.
void findBlack(const std::set<std::string>& allowed, Comparison& comparison) {
    std::vector<Finding> found;
    for (const LayerComparison& layer : comparison.layers) {
        if (layer.kind == LayerKind::Ids) continue;
        bool isBlackA = true, isBlackB = true;
        for (const ChannelComparison& channel : layer.channels) {
            if (layer.kind == LayerKind::Color && channel.name.ends_with("A")) continue;
            isBlackA = isBlackA && isZero(channel.figures.a);
            isBlackB = isBlackB && isZero(channel.figures.b);
        }
        if (isBlackA != isBlackB)
            found.push_back(
                {"black",
                 fmt::format("{}: the {} image is {} everywhere, the {} is not", layer.name,
                             isBlackA ? "first" : "second", layer.kind == LayerKind::Color ? "black" : "0",
                             isBlackA ? "second" : "first"),
                 !allowed.contains("black")});
    }
    std::ranges::move(found, std::back_inserter(comparison.findings));
}

// Layers that no limit and no noise test holds and that differ should not go unseen.
void noteUngated(Comparison& comparison) {
    std::vector<std::string> names;
    for (const LayerComparison& layer : comparison.layers) {
        if (comparison.noise && layer.kind != LayerKind::Ids) continue;
        const auto isGated = [&](const LimitCheck& check) {
            return check.where == layer.name ||
                   std::ranges::find(layer.channels, check.where, &ChannelComparison::name) !=
                       layer.channels.end();
        };
        const bool differs = !layer.figures.over.empty() && layer.figures.over.front().pixels > 0;
        if (differs && std::ranges::none_of(comparison.checks, isGated)) names.push_back(layer.name);
    }
    if (!names.empty())
        comparison.notes.push_back(fmt::format(
            "no limit holds {}, which differ; --max-rmse NAME=X sets one, --max-differing NAME=F of "
            "uint channels",
            fmt::join(names, ", ")));
}

// A name that is mistyped would leave out more, or less, than was meant.
void findUnknownNames(const Picture& a, const Picture& b, const FocusOptions& focus, Comparison& comparison) {
    for (const std::string& name : unknownNames(a, b, focus.onlyChannels))
        comparison.findings.push_back(
            {"nothing", fmt::format("no channel or layer is called {}, which --channels names", name), true});
    for (const std::string& name : unknownNames(a, b, focus.withoutChannels))
        comparison.notes.push_back(
            fmt::format("no channel or layer is called {}, which --ignore-channels names", name));
}

void addNoiseFindings(Comparison& comparison) {
    if (!comparison.noise || comparison.noise->passed()) return;
    const NoiseTest& noise = *comparison.noise;
    if (!noise.tooSmall.empty())
        comparison.findings.push_back(
            {"noise",
             fmt::format("{} differ, in too few pixels to tell that from noise; compare them with limits "
                         "instead",
                         fmt::join(noise.tooSmall, ", ")),
             true});
    if (noise.significantPixels > 0)
        comparison.findings.push_back(
            {"noise",
             fmt::format("{} of {} pixels differ by more than their noise, the largest by "
                         "{:.3g} standard deviations",
                         noise.significantPixels, noise.pixels, noise.largestZ),
             true});
    if (noise.significantRegionCount > 0) {
        const NoiseTest::Region& worst = noise.significantRegions.front();
        comparison.findings.push_back(
            {"noise",
             fmt::format(
                 "{} of {} regions differ by more than their noise; {} at {},{},{},{} by {:.3g} ({:.3g} %), "
                 "which noise does with a probability of {:.1e}",
                 noise.significantRegionCount, noise.regions, worst.channel, worst.box.x0, worst.box.y0,
                 worst.box.x1, worst.box.y1, worst.bias, 100.0 * worst.relativeBias, worst.probability),
             true});
    }
}

void noteSamples(const PreparedPair& pair, Comparison& comparison) {
    const auto samplesOf = [](const Picture& picture) {
        const auto& ints = picture.parts.front().image.ints;
        const auto found = ints.find("samplesPerPixel");
        return found == ints.end() ? std::string("unknown") : std::to_string(found->second);
    };
    const std::string a = samplesOf(pair.a), b = samplesOf(pair.b);
    if (a != b) comparison.notes.push_back(fmt::format("samples per pixel: {} against {}", a, b));
}

} // namespace

ComparedPair comparePictures(Picture&& a, Picture&& b, const CompareOptions& options) {
    Comparison result;
    findUnknownNames(a, b, options.focus, result);
    PreparedPair pair =
        preparePair(std::move(a), std::move(b), options.focus, options.allowed, result.findings);
    result.scale = pair.a.scale;
    if (!pair.focus.empty()) result.box = pair.focus.front().box;
    for (const Focus& focus : pair.focus) result.ignored += focus.ignoredCount;
    findNonFinite(pair, options.allowSameNonFinite, result);
    noteSamples(pair, result);
    for (const LayerPair& layer : pair.layers)
        result.layers.push_back(measureLayer(layer, pair.focus[layer.part], options.metrics));
    std::vector<PerceptionMaps> maps = addPerception(pair, options.perception, result);
    if (pair.layers.empty() && result.passed())
        result.findings.push_back({"nothing", "the images have no channel in common", true});
    findBlack(options.allowed, result);
    if (options.noise.isOn()) result.noise = testNoise(pair, options.noise);
    addNoiseFindings(result);
    checkLimits(options.limits, options.noise.isOn(), result);
    if (!result.layers.empty() && result.checks.empty() && !options.noise.isOn())
        result.findings.push_back(
            {"nothing",
             fmt::format("no limit holds any layer, for there are no colors: --max-rmse {}=X sets one",
                         result.layers.front().name),
             true});
    noteUngated(result);
    if (options.maxShift > 0) result.alignment = findAlignment(pair, result, options.maxShift);
    return {std::move(pair), std::move(result), std::move(maps)};
}

} // namespace rt
