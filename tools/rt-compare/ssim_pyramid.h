#pragma once
#include "tools/rt-compare/ssim.h"

#include <span>
#include <vector>

namespace rt {

/// Two planes as SSIM looks at them, `stride` values from row to row: variances and covariance of a and b
/// follow from those of their sum and difference, of which the latter keeps its digits where the planes are
/// alike.
struct SsimLevel {
    std::size_t width = 0, height = 0;
    std::size_t stride = 0;
    std::vector<float> sum;        ///< a + b - 1, about 0, so that little is lost where means are subtracted
    std::vector<float> difference; ///< a - b
    std::span<const std::uint8_t> ignored;
};

/// The planes, and smaller ones, each half as wide and high as the one before: means of 2x2 pixels, without
/// an odd row or column at the end. Kept from channel to channel, for its memory.
class SsimPyramid {
public:
    /// Values that are not finite, or below 0, count as 0 in linear light.
    void build(const SsimPlanes& planes, std::size_t levels);

    const std::vector<SsimLevel>& levels() const { return levels_; }

    /// Values that may be read beyond the last one of a plane.
    static constexpr std::size_t kSlack = 32;

private:
    void resize(const SsimPlanes& planes, std::size_t levels);
    void fillRows(const SsimPlanes& planes, std::size_t firstRow);

    std::vector<SsimLevel> levels_;
    std::vector<std::vector<std::uint8_t>> ignored_; // of the smaller levels
};

} // namespace rt
