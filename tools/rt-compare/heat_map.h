#pragma once
#include "tools/rt-compare/perception.h"

#include <vector>

namespace rt {

enum class HeatFigure {
    Flip, ///< of a layer of colours: 0 to 1
    Ssim, ///< of a layer of colours: 1 - SSIM, 0 to 1
    Abs,  ///< largest |a-b| over a layer's channels, against the largest of all its pixels
};

/// A figure of each pixel of a layer, from 0 to 1 (yellow); values that are not finite count as 1.
std::vector<float> heatValues(const PreparedPair& pair, const PerceptionMaps& maps, std::size_t layer,
                              HeatFigure figure);

/// The pixels of the first part: R, G, B show `figure` of its first layer (of colours, where there is one) by
/// heatColor(). The other channels, which a PNG has no place for, are the errors themselves: "error.X" is
/// |a-b| of channel X (uint: 0 or 1), "flip" and "ssim" are the maps of the first layer that has them, for
/// further layers with their name after a point.
Image heatMap(const PreparedPair& pair, const std::vector<PerceptionMaps>& maps, HeatFigure figure);

} // namespace rt
