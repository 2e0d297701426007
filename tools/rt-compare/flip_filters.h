#pragma once
#include <vector>

namespace rt {

/// One half of a filter along a line, the other is its mirror image, negated for odd filters.
struct LineFilter {
    std::vector<float> weights; ///< at distances 0, 1, ... radius
    int radius() const { return static_cast<int>(weights.size()) - 1; }
};

/// FLIP's filters taken apart into lines: a filter of the plane is the product of one along x and one along
/// y, or the sum of two such products. Both filters of blue-yellow have the same radius, and all of features.
struct FlipFilters {
    LineFilter achromatic, redGreen, blueYellowWide, blueYellowNarrow; ///< what the eye resolves of Y, Cx, Cz
    LineFilter smooth, edge, point; ///< Gaussian, its first (odd) and its second derivative
    int radius = 0;                 ///< the largest of all
};

/// Sources: Andersson et al. 2020, sections 4.1.1 and 4.2.1; the contrast sensitivity is fitted to
/// Movshon & Kiorpes 1988 and Mullen 1985.
FlipFilters makeFlipFilters(double pixelsPerDegree);

} // namespace rt
