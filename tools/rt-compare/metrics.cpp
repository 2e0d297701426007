#include "tools/rt-compare/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt {
namespace {

bool isUint(const ImageChannel& channel) {
    return channel.type == ImageChannel::Type::Uint;
}

const char* kindName(const ImageChannel& channel) {
    return isUint(channel) ? "uint" : "number";
}

// The channel of that name if both images have it as numbers.
std::pair<const ImageChannel*, const ImageChannel*> findBoth(const Image& a, const Image& b,
                                                             const std::string& name) {
    const ImageChannel *inA = a.find(name), *inB = b.find(name);
    if (!inA || !inB || isUint(*inA) || isUint(*inB)) return {nullptr, nullptr};
    return {inA, inB};
}

void requireSameChannels(const Image& a, const Image& b, std::vector<std::string>& failures) {
    for (const ImageChannel& channel : a.channels) {
        const ImageChannel* other = b.find(channel.name);
        if (!other)
            failures.push_back(fmt::format("channel {} is in the first image only", channel.name));
        else if (isUint(channel) != isUint(*other))
            failures.push_back(fmt::format("channel {} is {} against {}", channel.name, kindName(channel),
                                           kindName(*other)));
    }
    for (const ImageChannel& channel : b.channels)
        if (!a.find(channel.name))
            failures.push_back(fmt::format("channel {} is in the second image only", channel.name));
}

void requireFinite(const NonFiniteCounts& counts, const char* which, std::vector<std::string>& failures) {
    if (!counts.first) return;
    failures.push_back(fmt::format(
        "{} non-finite values in {} pixels of the {} image, first in {} at x {}, y {}", counts.total(),
        counts.pixels, which, counts.first->channel, counts.first->x, counts.first->y));
}

std::uint64_t countDiffering(const ImageChannel& a, const ImageChannel& b) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < a.uints.size(); ++i) count += a.uints[i] != b.uints[i] ? 1u : 0u;
    return count;
}

void compareChannels(const Image& a, const Image& b, Comparison& result) {
    for (const ImageChannel& channel : a.channels) {
        const ImageChannel* other = b.find(channel.name);
        if (!other || isUint(channel) != isUint(*other)) continue;
        if (isUint(channel))
            result.uints.push_back({channel.name, countDiffering(channel, *other)});
        else
            result.channels.push_back({channel.name, compareValues(channel, *other)});
    }
    for (const char* name : kColorChannels) {
        const auto [inA, inB] = findBoth(a, b, name);
        if (!inA) continue;
        if (!result.color) result.color.emplace();
        result.color->add(compareValues(*inA, *inB));
    }
}

// The first pixel, in the order of kColorChannels and then of rows, with the largest difference.
std::optional<WorstPixel> findWorst(const Image& a, const Image& b, double maxAbs) {
    if (maxAbs == 0.0) return std::nullopt;
    for (const char* name : kColorChannels) {
        const auto [inA, inB] = findBoth(a, b, name);
        if (!inA) continue;
        for (std::size_t i = 0; i < a.pixelCount(); ++i) {
            const double va = inA->values[i], vb = inB->values[i];
            if (std::abs(va - vb) == maxAbs)
                return WorstPixel{name, static_cast<std::uint32_t>(i % a.width),
                                  static_cast<std::uint32_t>(i / a.width), va, vb};
        }
    }
    return std::nullopt;
}

} // namespace

double ErrorSums::rmse() const {
    if (compared == 0) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(squaredSum / static_cast<double>(compared));
}

void ErrorSums::add(const ErrorSums& other) {
    values += other.values;
    compared += other.compared;
    squaredSum += other.squaredSum;
    maxAbs = std::max(maxAbs, other.maxAbs);
}

NonFiniteCounts countNonFinite(const Image& image) {
    NonFiniteCounts counts;
    std::vector<bool> isCounted(image.pixelCount());
    for (const ImageChannel& channel : image.channels) {
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            const float value = channel.values[i];
            if (std::isfinite(value)) continue;
            counts.pixels += isCounted[i] ? 0u : 1u;
            isCounted[i] = true;
            ++(std::isnan(value) ? counts.nan : value > 0.0f ? counts.positiveInf : counts.negativeInf);
            if (!counts.first)
                counts.first = {channel.name, static_cast<std::uint32_t>(i % image.width),
                                static_cast<std::uint32_t>(i / image.width), value};
        }
    }
    return counts;
}

ErrorSums compareValues(const ImageChannel& a, const ImageChannel& b) {
    ErrorSums sums;
    sums.values = a.values.size();
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double difference = double(a.values[i]) - double(b.values[i]);
        if (!std::isfinite(difference)) continue; // doubles hold every difference of finite floats
        ++sums.compared;
        sums.squaredSum += difference * difference;
        sums.maxAbs = std::max(sums.maxAbs, std::abs(difference));
    }
    return sums;
}

Comparison compareImages(const Image& a, const Image& b, double maxRmse) {
    Comparison result;
    result.nonFiniteA = countNonFinite(a);
    result.nonFiniteB = countNonFinite(b);
    if (a.width != b.width || a.height != b.height)
        result.failures.push_back(
            fmt::format("sizes differ: {} x {} against {} x {}", a.width, a.height, b.width, b.height));
    const bool sameSize = result.failures.empty();
    requireSameChannels(a, b, result.failures);
    requireFinite(result.nonFiniteA, "first", result.failures);
    requireFinite(result.nonFiniteB, "second", result.failures);
    if (!sameSize) return result;

    compareChannels(a, b, result);
    if (!result.color) {
        result.failures.push_back("no color channel (R, G, B, A) in common");
        return result;
    }
    result.worst = findWorst(a, b, result.color->maxAbs);
    const double rmse = result.color->rmse();
    if (!(rmse <= maxRmse)) // true for NaN too: nothing was compared
        result.failures.push_back(fmt::format("RMSE {} exceeds {}", rmse, maxRmse));
    return result;
}

} // namespace rt
