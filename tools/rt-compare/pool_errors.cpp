#include "tools/rt-compare/pool_errors.h"

#include "tools/rt-compare/error_counts.h"

#include <algorithm>
#include <array>
#include <bit>

namespace rt {
namespace {

constexpr std::array kPercents{50.0, 95.0, 99.0};

std::size_t binOf(float error) {
    return std::bit_cast<std::uint32_t>(error) >> 16;
}

// Sums of the errors in ascending order, as far as they are asked for: bins are, and one of them is sorted at
// a time.
class AscendingSums {
public:
    explicit AscendingSums(std::span<const float> errors) : errors_(errors), sums_(1u << 15) {
        for (const float error : errors) sums_[binOf(error)] += error;
        for (const double sum : sums_) total_ += sum;
    }

    double total() const { return total_; }

    // The error up to which the sum exceeds this part of the whole.
    double at(double part) const {
        const double wanted = part * total_;
        double below = 0.0;
        std::size_t bin = 0;
        while (bin + 1 < sums_.size() && below + sums_[bin] <= wanted) below += sums_[bin++];
        std::vector<float> inBin;
        for (const float error : errors_)
            if (binOf(error) == bin) inBin.push_back(error);
        std::ranges::sort(inBin);
        for (const float error : inBin)
            if ((below += error) > wanted) return error;
        return inBin.empty() ? 0.0 : inBin.back();
    }

private:
    std::span<const float> errors_;
    std::vector<double> sums_;
    double total_ = 0.0;
};

} // namespace

PooledErrors poolErrors(std::span<const float> errors) {
    const AscendingSums sums(errors);
    const auto [least, most] = std::minmax_element(errors.begin(), errors.end());
    PooledErrors pooled;
    pooled.mean = sums.total() / static_cast<double>(errors.size());
    pooled.min = *least;
    pooled.max = *most;
    pooled.percentiles = findPercentiles(errors, kPercents);
    if (sums.total() == 0.0) return pooled;
    pooled.firstWeightedQuartile = sums.at(0.25);
    pooled.weightedMedian = sums.at(0.5);
    pooled.thirdWeightedQuartile = sums.at(0.75);
    return pooled;
}

} // namespace rt
