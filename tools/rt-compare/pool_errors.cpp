#include "tools/rt-compare/pool_errors.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace rt {
namespace {

// Floats >= 0 are ordered as their bits are; the upper half of them makes the bin.
std::size_t binOf(float error) {
    return std::bit_cast<std::uint32_t>(error) >> 16;
}

// Errors in ascending order, as far as it is asked for: their bins are, and one of them is sorted at a time.
class AscendingErrors {
public:
    explicit AscendingErrors(std::span<const float> errors)
        : errors_(errors), sums_(1u << 15), counts_(1u << 15) {
        for (const float error : errors) {
            sums_[binOf(error)] += error;
            counts_[binOf(error)] += 1.0;
        }
        for (const double sum : sums_) total_ += sum;
    }

    double total() const { return total_; }

    // Where the sum of the errors up to there exceeds this part of the whole.
    double atSum(double part) const {
        return find(
            sums_, [&](double sum) { return sum > part * total_; },
            [](float error) { return double(error); });
    }
    // Where this part of the errors, by their number, is reached.
    double atCount(double part) const {
        const double count = part * static_cast<double>(errors_.size());
        return find(
            counts_, [&](double found) { return found >= count; }, [](float) { return 1.0; });
    }

private:
    template <class IsEnough, class Weight>
    double find(const std::vector<double>& bins, IsEnough&& isEnough, Weight&& weight) const {
        double below = 0.0;
        std::size_t bin = 0;
        while (bin + 1 < bins.size() && !isEnough(below + bins[bin])) below += bins[bin++];
        std::vector<float> inBin;
        for (const float error : errors_)
            if (binOf(error) == bin) inBin.push_back(error);
        std::sort(inBin.begin(), inBin.end());
        for (const float error : inBin)
            if (isEnough(below += weight(error))) return error;
        return inBin.empty() ? 0.0 : inBin.back();
    }

    std::span<const float> errors_;
    std::vector<double> sums_, counts_;
    double total_ = 0.0;
};

} // namespace

PooledErrors poolErrors(std::span<const float> errors) {
    const AscendingErrors ascending(errors);
    const auto [least, most] = std::minmax_element(errors.begin(), errors.end());
    PooledErrors pooled;
    pooled.mean = ascending.total() / static_cast<double>(errors.size());
    pooled.min = *least;
    pooled.max = *most;
    for (std::size_t i = 0; i < pooled.percentiles.size(); ++i)
        pooled.percentiles[i] = ascending.atCount(PooledErrors::kPercents[i] / 100.0);
    if (ascending.total() == 0.0) return pooled;
    pooled.firstWeightedQuartile = ascending.atSum(0.25);
    pooled.weightedMedian = ascending.atSum(0.5);
    pooled.thirdWeightedQuartile = ascending.atSum(0.75);
    return pooled;
}

} // namespace rt
