#include "tools/rt-compare/error_counts.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/float_lanes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace rt {
namespace {

constexpr std::size_t kBlock = 4096;                    // values; their bits stay in the cache
constexpr std::size_t kFineBins = std::size_t(1) << 16; // the lower 16 bits

inline Ints errorBits(const Floats& a, const Floats& b) {
    constexpr int kInfinite = 0x7F800000;
    const Ints error = bitsOf(absolute(a - b)), sizeA = bitsOf(absolute(a)), sizeB = bitsOf(absolute(b));
    const Ints isFinite = (sizeA < kInfinite) & (sizeB < kInfinite), most = Ints{} + (kInfinite - 1);
    return isFinite ? (error < most ? error : most) : Ints{} + int(kNoError);
}

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

void addFine(std::span<const std::uint32_t> bits, const Slots& slots, FineCounts& counts) {
    for (const std::uint32_t value : bits) {
        const int slot = slots.slotOfBin[value >> 16];
        if (slot >= 0) ++counts[static_cast<std::size_t>(slot) * kFineBins + (value & 0xFFFFu)];
    }
}

FineCounts countFine(const ChannelPair& channel, const ComparedRegion& focus, const Slots& slots) {
    FineCounts counts(slots.bins.size() * kFineBins);
    const std::vector<float>&a = channel.a->values, &b = channel.b->values;
    std::array<std::uint32_t, kBlock> bits;
    for (std::size_t first = 0; first < a.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, a.size() - first);
        findErrorBits(a.data() + first, b.data() + first,
                      focus.ignored.empty() ? nullptr : focus.ignored.data() + first, count, bits.data());
        addFine({bits.data(), count}, slots, counts);
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

RT_WIDE_LANES void findErrorBits(const float* a, const float* b, const std::uint8_t* ignored,
                                 std::size_t count, std::uint32_t* bits) {
    const std::size_t whole = count / kLanes * kLanes;
    for (std::size_t i = 0; i < whole; i += kLanes) {
        const Ints found = errorBits(loadFloats(a + i), loadFloats(b + i));
        std::memcpy(bits + i, &found, sizeof found);
    }
    const std::size_t rest = count - whole;
    const Ints found = errorBits(loadFloats(a + whole, rest), loadFloats(b + whole, rest));
    std::memcpy(bits + whole, &found, rest * sizeof(std::uint32_t));
    for (std::size_t i = 0; ignored && i < count; ++i)
        if (ignored[i]) bits[i] = kNoError;
}

void ErrorCounts::add(std::span<const std::uint32_t> bits) {
    for (std::size_t i = 0; i < bits.size();) {
        // Equal values come in crowds, and adding to the same count over and over is slow.
        const std::size_t end = std::min(i + 8, bits.size());
        std::uint32_t any = 0;
        for (std::size_t k = i; k < end; ++k) any |= bits[k];
        if (any == 0) {
            zeros += end - i;
            counts[0] += static_cast<std::uint32_t>(end - i);
            i = end;
        }
        for (; i < end; ++i) {
            ++counts[bits[i] >> 16];
            zeros += bits[i] == 0 ? 1u : 0u;
        }
    }
    counts[kNoError >> 16] = 0;
}

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
    std::vector<std::uint32_t> bits(errors.size());
    std::ranges::transform(errors, bits.begin(),
                           [](float error) { return std::bit_cast<std::uint32_t>(error); });
    ErrorCounts counts;
    counts.add(bits);
    const std::vector<CoarsePlace> places = locate(counts, percents);
    Slots slots;
    slots.add(places);
    FineCounts fine(slots.bins.size() * kFineBins);
    addFine(bits, slots, fine);
    return refine(places, percents, slots, fine);
}

} // namespace rt
