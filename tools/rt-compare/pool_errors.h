#pragma once
#include <array>
#include <span>

namespace rt {

/// A map of errors as a few numbers.
struct PooledErrors {
    static constexpr std::array<double, 3> kPercents{50.0, 95.0, 99.0};
    double mean = 0.0, min = 0.0, max = 0.0;
    /// The errors up to which the small ones add up to a quarter, half and three quarters of all errors
    /// together: large ones weigh more, however few they are.
    double firstWeightedQuartile = 0.0, weightedMedian = 0.0, thirdWeightedQuartile = 0.0;
    /// The smallest errors that at least so many per cent of all errors do not exceed.
    std::array<double, 3> percentiles{};
};

/// Of at least one error from 0 to 1. Source: Andersson et al. 2020, section 5.
PooledErrors poolErrors(std::span<const float> errors);

} // namespace rt
