#pragma once
#include <glm/vec3.hpp>

namespace rt {

/// A colour for t in [0, 1] whose lightness grows evenly: from dark violet over green to yellow.
/// sRGB-encoded, 0 to 1. Source: van der Walt & Smith 2015, "viridis"; 9 of its colours, straight lines
/// between.
glm::dvec3 heatColor(double t);

} // namespace rt
