#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rt {

/// |a - b| in single precision as bits, which are ordered as its values are; kNoError where one of them is
/// not finite, or ignored (nullptr: none is). What overflows is the largest number there is.
void findErrorBits(const float* a, const float* b, const std::uint8_t* ignored, std::size_t count,
                   std::uint32_t* bits);
inline constexpr std::uint32_t kNoError = 0x7FFFFFFFu; // above those of all numbers

/// How often each |a - b| occurs, by the upper 16 bits of what findErrorBits() finds: 128 steps for each
/// doubling.
struct ErrorCounts {
    std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(1u << 15);
    std::uint64_t zeros = 0; ///< also counted in counts[0]

    void add(std::span<const std::uint32_t> bits);
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
