#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rt {

/// Two planes of width*height values, row by row, display values from 0 to 1.
struct SsimPlanes {
    std::uint32_t width = 0, height = 0;
    std::span<const float> a, b;
    std::span<const std::uint8_t> ignored; ///< 1 = does not count as the middle of a window; empty: all do
};

/// Smallest width and height of pictures that SSIM and MS-SSIM are defined for.
inline constexpr std::uint32_t kSsimLeast = 11, kMsSsimLeast = 176;

/// Structural similarity, 1 for equal planes, of windows that lie whole in the picture: their mean, or 1
/// where no pixel counts. Nothing for pictures below kSsimLeast. The same bits for any number of threads.
/// Source: Wang et al. 2004, "Image Quality Assessment: From Error Visibility to Structural Similarity".
std::optional<double> ssim(const SsimPlanes& planes);

/// Each pixel's SSIM; those nearer to the edge than a window has room for repeat the nearest that is not.
std::vector<float> ssimMap(const SsimPlanes& planes);

/// Nothing for pictures below kMsSsimLeast.
/// Source: Wang et al. 2003, "Multi-scale Structural Similarity for Image Quality Assessment".
std::optional<double> msSsim(const SsimPlanes& planes);

} // namespace rt
