#include "tools/rt-compare/non_finite.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <cmath>

namespace rt {
namespace {

constexpr std::size_t kMaxPlaces = 10;

bool hasNonFinite(const std::vector<float>& values) {
    constexpr std::uint32_t kExponent = 0x7F800000u;
    std::uint32_t found = 0;
    for (const float value : values)
        found |= (std::bit_cast<std::uint32_t>(value) & kExponent) == kExponent ? 1u : 0u;
    return found != 0;
}

std::pair<std::int32_t, std::int32_t> positionOf(const PixelBox& box, std::size_t i) {
    return {box.x0 + static_cast<std::int32_t>(i % box.width()),
            box.y0 + static_cast<std::int32_t>(i / box.width())};
}

void countPart(const PicturePart& part, NonFiniteCounts& counts) {
    const std::vector<ImageChannel>& channels = part.image.channels;
    std::vector<std::uint8_t> isAffected(channels.size());
    tbb::parallel_for(std::size_t(0), channels.size(),
                      [&](std::size_t c) { isAffected[c] = hasNonFinite(channels[c].values); });
    std::vector<bool> isCounted;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        if (!isAffected[c]) continue;
        isCounted.resize(part.image.pixelCount());
        for (std::size_t i = 0; i < channels[c].values.size(); ++i) {
            const float value = channels[c].values[i];
            if (std::isfinite(value)) continue;
            counts.pixels += isCounted[i] ? 0u : 1u;
            isCounted[i] = true;
            ++(std::isnan(value) ? counts.nan : value > 0.0f ? counts.positiveInf : counts.negativeInf);
            if (counts.first) continue;
            const auto [x, y] = positionOf(part.dataWindow, i);
            counts.first = {channels[c].name, x, y, value};
        }
    }
}

NonFiniteCounts countNonFinite(const Picture& picture) {
    NonFiniteCounts counts;
    for (const PicturePart& part : picture.parts) countPart(part, counts);
    return counts;
}

// Looks at what both pictures have. Returns how many values that are not finite it met in each.
std::uint64_t comparePlaces(const PreparedPair& pair, Comparison& comparison) {
    std::uint64_t met = 0;
    for (const LayerPair& layer : pair.layers) {
        if (layer.kind == LayerKind::Ids) continue;
        for (const ChannelPair& channel : layer.channels) {
            for (std::size_t i = 0; i < channel.a->values.size(); ++i) {
                const float a = channel.a->values[i], b = channel.b->values[i];
                if (std::isfinite(a) && std::isfinite(b)) continue;
                met += std::uint64_t(!std::isfinite(a)) + std::uint64_t(!std::isfinite(b));
                const bool isSame = a == b || (std::isnan(a) && std::isnan(b));
                comparison.nonFiniteDiffering += isSame ? 0u : 1u;
                if (comparison.nonFinitePlaces.size() >= kMaxPlaces) continue;
                const auto [x, y] = positionOf(pair.regions[layer.part].box, i);
                comparison.nonFinitePlaces.push_back({channel.name, x, y, a, b});
            }
        }
    }
    return met;
}

std::string describe(const NonFiniteCounts& counts, const char* which) {
    return fmt::format("{} non-finite values in {} pixels of the {} image, first in {} at x {}, y {}: "
                       "{} NaN, {} +Inf, {} -Inf",
                       counts.total(), counts.pixels, which, counts.first->channel, counts.first->x,
                       counts.first->y, counts.nan, counts.positiveInf, counts.negativeInf);
}

} // namespace

void findNonFinite(const PreparedPair& pair, bool allowSame, Comparison& comparison) {
    comparison.nonFiniteA = countNonFinite(pair.a);
    comparison.nonFiniteB = countNonFinite(pair.b);
    const std::uint64_t total = comparison.nonFiniteA.total() + comparison.nonFiniteB.total();
    if (total == 0) return;
    const std::uint64_t met = comparePlaces(pair, comparison);
    comparison.nonFiniteDiffering += total - met; // in channels and parts that only one picture has
    const bool fails = !allowSame || comparison.nonFiniteDiffering > 0;
    for (const auto& [counts, which] :
         {std::pair(&comparison.nonFiniteA, "first"), {&comparison.nonFiniteB, "second"}})
        if (counts->first)
            comparison.findings.push_back({FindingKind::NonFinite, describe(*counts, which), fails});
    if (allowSame && fails)
        comparison.findings.push_back(
            {FindingKind::NonFinite,
             fmt::format("{} of them are not the same in both images", comparison.nonFiniteDiffering)});
}

} // namespace rt
