#include "tools/rt-compare/plain_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt {
namespace {

double valueAt(const ImageChannel& channel, std::size_t pixel) {
    return channel.uints.empty() ? double(channel.values[pixel]) : double(channel.uints[pixel]);
}

} // namespace

PlainFigures::PlainFigures(const LayerPair& layer, const ComparedRegion& region, double peak)
    : layer_(layer), region_(region), peak_(peak) {
    for (std::size_t i = 0; i < region.box.pixelCount(); ++i) {
        if (!region.isCompared(i)) continue;
        double largest = 0.0;
        for (const ChannelPair& channel : layer.channels) add(channel, i, largest);
        pixelErrors_.push_back(largest);
    }
}

void PlainFigures::add(const ChannelPair& channel, std::size_t pixel, double& largest) {
    const double a = valueAt(*channel.a, pixel), b = valueAt(*channel.b, pixel);
    if (std::isfinite(a) && std::isfinite(b)) {
        values_.emplace_back(a, b);
        isEqual_ = isEqual_ && a == b;
        largest = std::max(largest, std::abs(a - b));
    } else if (!(a == b || (std::isnan(a) && std::isnan(b)))) {
        isEqual_ = false;
        nonFiniteDiffers_ = true;
        largest = std::numeric_limits<double>::infinity();
    }
}

bool PlainFigures::isBlackIn(const ImageChannel* ChannelPair::*side) const {
    for (const ChannelPair& channel : layer_.channels)
        for (std::size_t i = 0; i < region_.box.pixelCount(); ++i)
            if (region_.isCompared(i) && splitChannelName(channel.a->name).last != "A" &&
                valueAt(*(channel.*side), i) != 0.0)
                return false;
    return true;
}

double PlainFigures::mse() const {
    return mean([](double a, double b) { return (a - b) * (a - b); });
}

template <class Function>
double PlainFigures::mean(Function function) const {
    double sum = 0.0;
    for (const auto& [a, b] : values_) sum += function(a, b);
    return sum / static_cast<double>(values_.size());
}

std::optional<double> PlainFigures::of(Metric metric, double parameter) const {
    switch (metric) {
    case Metric::MaxAbs:
        return *std::ranges::max_element(pixelErrors_);
    case Metric::Mae:
        return mean([](double a, double b) { return std::abs(a - b); });
    case Metric::Mse:
        return mse();
    case Metric::Rmse:
        return std::sqrt(mse());
    case Metric::RelMse:
        return mean([](double a, double b) { return (a - b) * (a - b) / (b * b + 0.01); });
    case Metric::Smape:
        return mean([](double a, double b) { return std::abs(a - b) / (std::abs(a) + std::abs(b) + 0.01); });
    case Metric::Psnr:
        return 10.0 * std::log10(peak_ * peak_ / mse());
    case Metric::Over:
    case Metric::Differing:
        return static_cast<double>(
                   std::ranges::count_if(pixelErrors_, [&](double e) { return e > parameter; })) /
               static_cast<double>(pixelErrors_.size());
    default:
        return std::nullopt;
    }
}

} // namespace rt
