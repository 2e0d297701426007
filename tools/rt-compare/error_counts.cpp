#include "tools/rt-compare/error_counts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace rt {
namespace {

constexpr std::size_t kFineBins = std::size_t(1) << 16; // the lower 16 bits

/// Where the value of a rank is: its upper bits, and its rank among those that share them (from 1).
struct CoarsePlace {
    std::size_t bin = 0;
    std::uint64_t rank = 0;
};

std::uint64_t totalOf(const ErrorCounts& counts) {
    return std::accumulate(counts.counts.begin(), counts.counts.end(), std::uint64_t(0));
}

std::vector<CoarsePlace> locate(const ErrorCounts& counts, std::span<const double> percents) {
    std::vector<CoarsePlace> places;
    const std::uint64_t total = totalOf(counts);
    if (total == 0) return places;
    std::size_t bin = 0;
    std::uint64_t below = 0; // values in lower bins
    for (const double percent : percents) {
        const auto rank = static_cast<std::uint64_t>(std::ceil(percent / 100.0 * static_cast<double>(total)));
        const std::uint64_t wanted = std::clamp<std::uint64_t>(rank, 1, total);
        while (below + counts.counts[bin] < wanted) below += counts.counts[bin++];
        places.push_back({bin, wanted - below});
    }
    return places;
}

/// The bins to look into, and for each bin its number among them.
struct Slots {
    std::vector<std::size_t> bins;
    std::vector<int> slotOfBin = std::vector<int>(1u << 15, -1);

    void add(const std::vector<CoarsePlace>& places) {
        for (const CoarsePlace& place : places) {
            if (slotOfBin[place.bin] >= 0) continue;
            slotOfBin[place.bin] = static_cast<int>(bins.size());
            bins.push_back(place.bin);
        }
    }
};

using FineCounts = std::vector<std::uint32_t>; // kFineBins for each slot

void addFine(double absError, const Slots& slots, FineCounts& counts) {
    const std::uint32_t bits = absErrorBits(absError);
    const int slot = slots.slotOfBin[bits >> 16];
    if (slot >= 0) ++counts[static_cast<std::size_t>(slot) * kFineBins + (bits & 0xFFFFu)];
}

FineCounts countFine(const ChannelPair& channel, const ComparedRegion& focus, const Slots& slots) {
    FineCounts counts(slots.bins.size() * kFineBins);
    const std::vector<float>&a = channel.a->values, &b = channel.b->values;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double absError = std::abs(double(a[i]) - double(b[i]));
        if (!std::isfinite(absError) || !focus.isCompared(i)) continue;
        addFine(absError, slots, counts);
    }
    return counts;
}

std::vector<Percentile> refine(const std::vector<CoarsePlace>& places, std::span<const double> percents,
                               const Slots& slots, const FineCounts& fine) {
    std::vector<Percentile> result;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t first = static_cast<std::size_t>(slots.slotOfBin[places[i].bin]) * kFineBins;
        std::uint32_t low = 0;
        for (std::uint64_t seen = fine[first]; seen < places[i].rank; seen += fine[first + low]) ++low;
        const std::uint32_t bits = static_cast<std::uint32_t>(places[i].bin) << 16 | low;
        result.push_back({percents[i], std::bit_cast<float>(bits)});
    }
    return result;
}

} // namespace

void ErrorCounts::add(const ErrorCounts& other) {
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
    zeros += other.zeros;
}

ErrorHistogram histogramOf(const ErrorCounts& counts) {
    ErrorHistogram histogram;
    constexpr int kLast = static_cast<int>(ErrorHistogram::kBins) - 1;
    for (std::size_t i = 0; i < counts.counts.size(); ++i) {
        const int exponent = static_cast<int>(i >> 7) - 127; // of a float's upper bits
        const int bin = std::clamp(exponent - ErrorHistogram::kLowestExponent + 1, 1, kLast);
        histogram.counts[static_cast<std::size_t>(bin)] += counts.counts[i];
    }
    histogram.counts[1] -= counts.zeros;
    histogram.counts[0] = counts.zeros;
    return histogram;
}

std::vector<std::vector<Percentile>> findPercentiles(const LayerPair& layer, const ComparedRegion& focus,
                                                     const std::vector<ErrorCounts>& channelCounts,
                                                     std::span<const double> percents) {
    std::vector<std::vector<CoarsePlace>> places; // of each channel, then of all
    ErrorCounts all;
    Slots slots;
    for (const ErrorCounts& counts : channelCounts) {
        all.add(counts);
        places.push_back(locate(counts, percents));
    }
    places.push_back(locate(all, percents));
    for (const std::vector<CoarsePlace>& wanted : places) slots.add(wanted);

    std::vector<FineCounts> fine(layer.channels.size());
    tbb::parallel_for(std::size_t(0), fine.size(),
                      [&](std::size_t c) { fine[c] = countFine(layer.channels[c], focus, slots); });
    std::vector<std::vector<Percentile>> result;
    FineCounts sum(slots.bins.size() * kFineBins);
    for (std::size_t c = 0; c < fine.size(); ++c) {
        result.push_back(refine(places[c], percents, slots, fine[c]));
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += fine[c][i];
    }
    result.push_back(refine(places.back(), percents, slots, sum));
    return result;
}

std::vector<Percentile> findPercentiles(std::span<const float> errors, std::span<const double> percents) {
    ErrorCounts counts;
    for (const float error : errors) counts.add(error);
    const std::vector<CoarsePlace> places = locate(counts, percents);
    Slots slots;
    slots.add(places);
    FineCounts fine(slots.bins.size() * kFineBins);
    for (const float error : errors) addFine(error, slots, fine);
    return refine(places, percents, slots, fine);
}

} // namespace rt
