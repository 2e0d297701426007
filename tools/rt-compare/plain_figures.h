#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <optional>
#include <utility>
#include <vector>

namespace rt {

/// The figures of a layer once more, by loops too plain to be wrong in the same way: for the self-test.
class PlainFigures {
public:
    PlainFigures(const LayerPair& layer, const ComparedRegion& region, double peak);

    bool isEqual() const { return isEqual_; }                     ///< every value, NaN to NaN
    bool nonFiniteDiffers() const { return nonFiniteDiffers_; }   ///< in kind or place
    bool isBlackIn(const ImageChannel* ChannelPair::*side) const; ///< 0 everywhere, but for opacity

    /// Nothing for figures that are not computed here.
    std::optional<double> of(Metric metric, double parameter) const;

private:
    void add(const ChannelPair& channel, std::size_t pixel, double& largest);
    template <class Function>
    double mean(Function function) const;
    double mse() const;

    const LayerPair& layer_;
    const ComparedRegion& region_;
    double peak_;
    bool isEqual_ = true, nonFiniteDiffers_ = false;
    std::vector<std::pair<double, double>> values_; // a, b: all that are finite in both
    std::vector<double> pixelErrors_;               // the largest of each pixel
};

} // namespace rt
