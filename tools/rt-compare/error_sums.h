#pragma once
#include "tools/rt-compare/comparison.h"
#include "tools/rt-compare/error_counts.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace rt {

inline constexpr std::size_t kBlockPixels = 2048; ///< their errors stay in the cache
inline constexpr double kIgnored = -1.0;          ///< in arrays of errors

/// Of the values of one image that are finite.
struct RangeSums {
    double min = std::numeric_limits<double>::infinity(), max = -min, sum = 0.0;
    std::uint64_t finite = 0;

    void add(const RangeSums& other) {
        min = std::min(min, other.min);
        max = std::max(max, other.max);
        sum += other.sum;
        finite += other.finite;
    }
    ValueRange range() const {
        if (finite == 0) return {};
        return {min, max, sum / static_cast<double>(finite)};
    }
};

/// Of values that count; the sums are of those that are finite in both images.
struct ErrorSums {
    std::uint64_t values = 0, compared = 0;
    double difference = 0.0, absolute = 0.0, square = 0.0, relative = 0.0, symmetric = 0.0, maxAbs = 0.0;
    RangeSums a, b;

    void add(const ErrorSums& other) {
        values += other.values;
        compared += other.compared;
        difference += other.difference;
        absolute += other.absolute;
        square += other.square;
        relative += other.relative;
        symmetric += other.symmetric;
        maxAbs = std::max(maxAbs, other.maxAbs);
        a.add(other.a);
        b.add(other.b);
    }
};

/// Adds the values of one channel's block of at most kBlockPixels pixels; errors[i] becomes |a - b|, infinite
/// where that is not finite, kIgnored where ignored[i] is set. `ignored` may be null.
void measureBlock(const float* a, const float* b, const std::uint8_t* ignored, std::size_t count,
                  double* errors, ErrorSums& sums, ErrorCounts& counts);

} // namespace rt
