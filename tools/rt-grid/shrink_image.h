#pragma once
#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>

namespace rt {

/// A rectangle of RGBA8 texels inside a larger array: row y begins at first + y * stride.
struct TexelBlock {
    std::uint32_t* first;
    std::size_t stride;
    glm::uvec2 size; ///< >= 1
};

/// Paints `to`, the next smaller level of `from`: each side is half of from's, rounded down, at least 1. A
/// texel is the mean of the area that it covers: 2 texels along a side of even length, 3 of which the outer
/// ones count in part where it is odd. kImageSrgb: colours are averaged as linear light, weighted by alpha,
/// so that what cannot be seen does not tinge what can. kImageLinear: all four as the numbers that they are.
void shrinkImage(const TexelBlock& from, const TexelBlock& to, std::uint32_t space);

} // namespace rt
