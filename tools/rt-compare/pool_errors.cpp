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

class WeightedOrder {
public:
    explicit WeightedOrder(std::span<const float> errors) : errors_(errors), sums_(1u << 15) {
        for (const float error : errors) sums_[binOf(error)] += error;
        for (const double sum : sums_) total_ += sum;
    }

    double total() const { return total_; }

    // The error at which the ascending errors' sum exceeds this part of the whole.
    double at(double part) const {
        double below = 0.0;
        std::size_t bin = 0;
        while (bin + 1 < sums_.size() && below + sums_[bin] <= part * total_) below += sums_[bin++];
        std::vector<float> inBin;
        for (const float error : errors_)
            if (binOf(error) == bin) inBin.push_back(error);
        std::sort(inBin.begin(), inBin.end());
        for (const float error : inBin)
            if ((below += error) > part * total_) return error;
        return inBin.empty() ? 0.0 : inBin.back();
    }

private:
    std::span<const float> errors_;
    std::vector<double> sums_;
    double total_ = 0.0;
};

} // namespace

PooledErrors poolErrors(std::span<const float> errors) {
    const WeightedOrder order(errors);
    const auto [least, most] = std::minmax_element(errors.begin(), errors.end());
    PooledErrors pooled{order.total() / static_cast<double>(errors.size()), *least, *most};
    if (order.total() == 0.0) return pooled;
    pooled.firstWeightedQuartile = order.at(0.25);
    pooled.weightedMedian = order.at(0.5);
    pooled.thirdWeightedQuartile = order.at(0.75);
    return pooled;
}

} // namespace rt
