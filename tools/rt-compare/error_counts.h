#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace rt {

/// |a - b| in single precision, whose bits are ordered as its values are.
inline std::uint32_t absErrorBits(double absError) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::min(absError, kLargest)));
}

/// How often each |a - b| occurs, by the upper 16 bits of absErrorBits(): 128 steps for each doubling.
struct ErrorCounts {
    std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(1u << 15);
    std::uint64_t zeros = 0; ///< also counted in counts[0]

    void add(double absError) {
        ++counts[absErrorBits(absError) >> 16];
        zeros += absError == 0.0 ? 1u : 0u;
    }
    void add(const ErrorCounts& other);
};

ErrorHistogram histogramOf(const ErrorCounts& counts);

/// Exact percentiles of each channel and, last, of all together, from the counts of each channel: one more
/// pass over the values that share the upper bits of an answer.
std::vector<std::vector<Percentile>> findPercentiles(const LayerPair& layer, const ComparedRegion& focus,
                                                     const std::vector<ErrorCounts>& channelCounts,
                                                     std::span<const double> percents);

/// The same of errors >= 0, all of which count.
std::vector<Percentile> findPercentiles(std::span<const float> errors, std::span<const double> percents);

} // namespace rt
