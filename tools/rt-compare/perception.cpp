#include "tools/rt-compare/perception.h"

#include "tools/rt-compare/pool_errors.h"
#include "tools/rt-compare/ssim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

using Values = std::span<const float>;

// Colours of a layer in both pictures: R, G and B (those that are missing are black) or Y thrice.
struct LayerColors {
    ColorPlanes a, b;
    std::size_t distinct = 0; // planes that differ from each other: 1 or 3
    std::vector<float> black;
};

std::optional<LayerColors> colorsOf(const PreparedPair& pair, const LayerPair& layer) {
    LayerColors colors;
    const ChannelPair* channels[3] = {layer.find("R"), layer.find("G"), layer.find("B")};
    const bool isColored = channels[0] || channels[1] || channels[2];
    if (!isColored) std::ranges::fill(channels, layer.find("Y"));
    if (!isColored && !channels[0]) return std::nullopt;
    const PixelBox& box = pair.regions[layer.part].box;
    colors.distinct = isColored ? 3 : 1;
    for (ColorPlanes* const planes : {&colors.a, &colors.b}) {
        planes->width = box.width();
        planes->height = box.height();
        planes->encoding =
            pair.a.scale == ValueScale::Display ? ColorPlanes::Encoding::Srgb : ColorPlanes::Encoding::Linear;
    }
    colors.black.resize(colors.a.pixelCount());
    for (std::size_t c = 0; c < 3; ++c) {
        colors.a.planes[c] = channels[c] ? Values(channels[c]->a->values) : Values(colors.black);
        colors.b.planes[c] = channels[c] ? Values(channels[c]->b->values) : Values(colors.black);
    }
    return colors;
}

FlipFigures figuresOf(const PooledErrors& pooled) {
    FlipFigures figures;
    figures.mean = pooled.mean;
    figures.min = pooled.min;
    figures.max = pooled.max;
    figures.firstQuartile = pooled.firstWeightedQuartile;
    figures.weightedMedian = pooled.weightedMedian;
    figures.thirdQuartile = pooled.thirdWeightedQuartile;
    figures.percentiles = pooled.percentiles;
    return figures;
}

// Explicit exposures may show nothing of any picture, and so no difference.
bool areExposuresBlind(const LayerColors& colors, const ExposureRange& exposures) {
    const auto isLit = [](const ColorPlanes& picture) {
        return std::ranges::any_of(picture.planes, [](Values plane) {
            return std::ranges::any_of(plane, [](float v) { return v > 0.0f; });
        });
    };
    const ColorPlanes& seen = isLit(colors.b) ? colors.b : colors.a;
    return isLit(seen) && !showsAnything(seen, exposures);
}

// The second picture is the reference.
std::vector<float> addFlip(const LayerColors& colors, const std::vector<std::uint8_t>& ignored,
                           const PerceptionOptions& options, LayerComparison& layer) {
    const bool isHdr = colors.a.encoding == ColorPlanes::Encoding::Linear;
    AutomaticExposures exposures;
    if (options.exposures)
        exposures.range = *options.exposures;
    else if (isHdr)
        exposures = automaticExposures(colors.b, colors.a);
    std::vector<float> map = isHdr ? flipHdr(colors.b, colors.a, exposures.range, options.pixelsPerDegree)
                                   : flipLdr(colors.b, colors.a, options.pixelsPerDegree);
    std::vector<float> counted;
    for (std::size_t i = 0; i < ignored.size(); ++i) {
        if (!ignored[i]) counted.push_back(map[i]);
        if (ignored[i]) map[i] = 0.0f;
    }
    const bool isBlind = isHdr && options.exposures && areExposuresBlind(colors, *options.exposures);
    if (isBlind)
        exposures.note = "at none of the exposures the reference is neither black nor white; see --exposures";
    if (!isBlind && (ignored.empty() || !counted.empty()))
        layer.flip = figuresOf(poolErrors(ignored.empty() ? Values(map) : Values(counted)));
    else
        layer.flip.emplace();
    layer.flip->hdr = isHdr;
    layer.flip->pixelsPerDegree = options.pixelsPerDegree;
    if (!isHdr) return map;
    layer.flip->startExposure = exposures.range.start;
    layer.flip->stopExposure = exposures.range.stop;
    layer.flip->exposures = static_cast<int>(exposures.range.count);
    layer.flip->note = exposures.note;
    return map;
}

void noteTooSmall(const LayerComparison& layer, const char* what, std::uint32_t least,
                  Comparison& comparison) {
    comparison.notes.push_back(
        fmt::format("{}: no {} of a picture of less than {} x {} pixels", layer.name, what, least, least));
}

std::vector<float> addSimilarity(const LayerColors& colors, const std::vector<std::uint8_t>& ignored,
                                 const PerceptionOptions& options, LayerComparison& layer) {
    std::vector<float> map;
    double single = 0.0, multi = 0.0;
    const float share = 1.0f / static_cast<float>(colors.distinct);
    SsimMeter meter;
    for (std::size_t c = 0; c < colors.distinct; ++c) {
        const SsimPlanes planes{
            colors.a.width,     colors.a.height, colors.a.planes[c],
            colors.b.planes[c], ignored,         colors.a.encoding == ColorPlanes::Encoding::Linear};
        const SsimFigures found = meter.measure(planes, {options.ssim, options.msSsim, options.ssimMap});
        single += found.single.value_or(kNotComputed);
        multi += found.multi.value_or(kNotComputed);
        map.resize(found.map.size());
        for (std::size_t i = 0; i < map.size(); ++i) map[i] += share * found.map[i];
    }
    const auto meanOf = [&](double sum) { return sum / static_cast<double>(colors.distinct); };
    if (!std::isnan(single)) layer.ssim = meanOf(single);
    if (!std::isnan(multi)) layer.msSsim = meanOf(multi);
    return map;
}

} // namespace

std::vector<PerceptionMaps> addPerception(const PreparedPair& pair, const PerceptionOptions& options,
                                          Comparison& comparison) {
    std::vector<PerceptionMaps> maps(pair.layers.size());
    for (std::size_t i = 0; i < pair.layers.size(); ++i) {
        LayerComparison& layer = comparison.layers[i];
        if (layer.kind != LayerKind::Color ||
            !(options.flip || options.ssim || options.msSsim || options.ssimMap))
            continue;
        const std::optional<LayerColors> colors = colorsOf(pair, pair.layers[i]);
        if (!colors || colors->a.pixelCount() == 0) continue;
        const std::vector<std::uint8_t>& ignored = pair.regions[layer.part].ignored;
        if (options.flip) maps[i].flip = addFlip(*colors, ignored, options, layer);
        if (options.ssim || options.msSsim || options.ssimMap)
            maps[i].ssim = addSimilarity(*colors, ignored, options, layer);
        if (options.ssim && !layer.ssim) noteTooSmall(layer, "SSIM", kSsimLeast, comparison);
        if (options.msSsim && !layer.msSsim) noteTooSmall(layer, "MS-SSIM", kMsSsimLeast, comparison);
    }
    return maps;
}

} // namespace rt
