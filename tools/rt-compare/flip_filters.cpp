#include "tools/rt-compare/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace rt {
namespace {

using std::numbers::pi;

// Contrast sensitivity as a sum of Gaussians amplitude * sqrt(pi / spread) * exp(-pi^2 degrees^2 / spread).
struct Sensitivity {
    double amplitude, spread;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053};
constexpr Sensitivity kBlueYellowWide{34.1, 0.04}, kBlueYellowNarrow{13.5, 0.025};
constexpr double kFeatureWidthDegrees = 0.082;

// Weights below this part of the largest do not change a sum of floats.
constexpr double kNegligible = 1e-8;

using Half = std::vector<double>; // at distances 0, 1, ...

template <class Value>
Half sampled(int radius, Value&& value) {
    Half half;
    for (int x = 0; x <= radius; ++x) half.push_back(value(double(x)));
    return half;
}

double sumOf(const Half& half) {
    double sum = half[0];
    for (std::size_t i = 1; i < half.size(); ++i) sum += 2.0 * half[i];
    return sum;
}

LineFilter scaled(const Half& half, double factor) {
    double largest = 0.0;
    for (const double weight : half) largest = std::max(largest, std::abs(weight));
    LineFilter filter;
    for (const double weight : half) filter.weights.push_back(static_cast<float>(weight * factor));
    std::size_t size = half.size();
    while (size > 1 && std::abs(half[size - 1]) < kNegligible * largest) --size;
    filter.weights.resize(size);
    return filter;
}

Half sensitivityLine(const Sensitivity& s, int radius, double pixelsPerDegree) {
    return sampled(radius, [&](double x) {
        const double degrees = x / pixelsPerDegree;
        return std::exp(-pi * pi * degrees * degrees / s.spread);
    });
}

void addSensitivities(FlipFilters& filters, double pixelsPerDegree) {
    const double widest = std::sqrt(kBlueYellowWide.spread / (2.0 * pi * pi)); // standard deviation, degrees
    const int radius = static_cast<int>(std::ceil(3.0 * widest * pixelsPerDegree));
    const auto line = [&](const Sensitivity& s) { return sensitivityLine(s, radius, pixelsPerDegree); };
    const Half achromatic = line(kAchromatic), redGreen = line(kRedGreen);
    filters.achromatic = scaled(achromatic, 1.0 / sumOf(achromatic));
    filters.redGreen = scaled(redGreen, 1.0 / sumOf(redGreen));
    // The two Gaussians of blue-yellow add up to 1 together; each has half of its factor along x and y.
    const Half wide = line(kBlueYellowWide), narrow = line(kBlueYellowNarrow);
    const auto heightOf = [](const Sensitivity& s) { return s.amplitude * std::sqrt(pi / s.spread); };
    const double volumeWide = heightOf(kBlueYellowWide) * sumOf(wide) * sumOf(wide);
    const double volumeNarrow = heightOf(kBlueYellowNarrow) * sumOf(narrow) * sumOf(narrow);
    const double volume = volumeWide + volumeNarrow;
    filters.blueYellowWide = scaled(wide, std::sqrt(heightOf(kBlueYellowWide) / volume));
    filters.blueYellowNarrow = scaled(narrow, std::sqrt(heightOf(kBlueYellowNarrow) / volume));
}

// Derivatives are scaled so that the weights of each sign add up to 1 in size.
void addFeatures(FlipFilters& filters, double pixelsPerDegree) {
    const double deviation = 0.5 * kFeatureWidthDegrees * pixelsPerDegree; // pixels
    const int radius = static_cast<int>(std::ceil(3.0 * deviation));
    const auto gauss = [&](double x) { return std::exp(-x * x / (2.0 * deviation * deviation)); };
    const Half smooth = sampled(radius, gauss);
    const Half edge = sampled(radius, [&](double x) { return -x * gauss(x); });
    Half point =
        sampled(radius, [&](double x) { return (x * x / (deviation * deviation) - 1.0) * gauss(x); });
    double negative = point[0], positive = 0.0, edgeSum = 0.0;
    for (int x = 1; x <= radius; ++x) {
        const auto i = static_cast<std::size_t>(x);
        (point[i] < 0.0 ? negative : positive) += 2.0 * point[i];
        edgeSum += edge[i];
    }
    for (double& weight : point) weight /= weight < 0.0 ? -negative : positive;
    filters.smooth = scaled(smooth, 1.0 / sumOf(smooth));
    filters.edge = scaled(edge, edgeSum != 0.0 ? -1.0 / edgeSum : 0.0);
    filters.point = scaled(point, 1.0);
}

// Filters that are applied together; what is added is 0.
void makeAsLong(std::initializer_list<LineFilter*> filters) {
    std::size_t longest = 0;
    for (const LineFilter* filter : filters) longest = std::max(longest, filter->weights.size());
    for (LineFilter* filter : filters) filter->weights.resize(longest);
}

} // namespace

FlipFilters makeFlipFilters(double pixelsPerDegree) {
    FlipFilters filters;
    addSensitivities(filters, pixelsPerDegree);
    addFeatures(filters, pixelsPerDegree);
    makeAsLong({&filters.blueYellowWide, &filters.blueYellowNarrow});
    makeAsLong({&filters.smooth, &filters.edge, &filters.point});
    for (const LineFilter* filter :
         {&filters.achromatic, &filters.redGreen, &filters.blueYellowWide, &filters.blueYellowNarrow,
          &filters.smooth, &filters.edge, &filters.point})
        filters.radius = std::max(filters.radius, filter->radius());
    return filters;
}

} // namespace rt
