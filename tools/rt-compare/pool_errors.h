#pragma once
#include "tools/rt-compare/comparison.h"

#include <span>
#include <vector>

namespace rt {

/// A map of errors as a few numbers.
struct PooledErrors {
    double mean = 0.0, min = 0.0, max = 0.0;
    /// The errors up to which the small ones add up to a quarter, half and three quarters of all errors
    /// together: large ones weigh more, however few they are.
    double firstWeightedQuartile = 0.0, weightedMedian = 0.0, thirdWeightedQuartile = 0.0;
    std::vector<Percentile> percentiles; ///< of the errors by their number: 50, 95 and 99
};

/// Of at least one error from 0 to 1. Source: Andersson et al. 2020, section 5.
PooledErrors poolErrors(std::span<const float> errors);

} // namespace rt
