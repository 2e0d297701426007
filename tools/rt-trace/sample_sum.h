#pragma once
#include "formats/image.h"

#include <vector>

namespace rt {

/// What pixels have of several ranges of their samples, put together. Of channels that are means over a
/// pixel's samples the mean of all of them, of the variance of the mean luminance that of all of them (Chan,
/// Golub & LeVeque 1979), of what the first sample sees what the first range says. Sums are in double.
class SampleSum {
public:
    /// The next range: means over so many samples. All ranges have the same channels, which channelRule()
    /// knows; the first one has a pixel's first sample.
    void add(const Image& image, unsigned samples);
    Image result() const;

private:
    void addMeans(const ImageChannel& channel, unsigned samples, std::vector<double>& sums);
    void addVariances(const Image& image, unsigned samples, std::vector<double>& sums);

    double samples_ = 0.0; // so far
    Image image_;          // the first range's
    std::vector<std::vector<double>>
        sums_;                       // by channel: of the values, or squares of distances from the mean
    std::vector<double> luminances_; // means, where there is a variance
};

} // namespace rt
