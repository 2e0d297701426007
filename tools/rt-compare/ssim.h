#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rt {

/// Two planes of width*height values, row by row.
struct SsimPlanes {
    std::uint32_t width = 0, height = 0;
    std::span<const float> a, b;
    std::span<const std::uint8_t> ignored; ///< 1 = does not count as the middle of a window; empty: all do
    bool isLinear = false; ///< light, compared as sRGB(v / (1 + v)); else display values from 0 to 1
};

/// Smallest width and height of pictures that SSIM and MS-SSIM are defined for.
inline constexpr std::uint32_t kSsimLeast = 11, kMsSsimLeast = 176;

struct SsimWants {
    bool single = false, multi = false, map = false;
};

struct SsimFigures {
    std::optional<double> single; ///< SSIM; absent: not wanted, or the picture is below kSsimLeast
    std::optional<double> multi;  ///< MS-SSIM; absent: not wanted, or the picture is below kMsSsimLeast
    std::vector<float> map;       ///< empty if not wanted; 1 where the picture is below kSsimLeast
};

class SsimPyramid;

/// Structural similarity, 1 for equal planes, of windows that lie whole in the picture: their mean, or 1
/// where no pixel counts. In the map, pixels nearer to the edge than a window has room for repeat the nearest
/// that is not. In single precision, within 1e-6 of the mean in double; the same bits for any
/// number of threads. Sources: Wang et al. 2004, "Image Quality Assessment: From Error Visibility to
/// Structural Similarity"; Wang et al. 2003, "Multi-scale Structural Similarity for Image Quality
/// Assessment".
class SsimMeter {
public:
    SsimMeter();
    ~SsimMeter();
    SsimFigures measure(const SsimPlanes& planes, const SsimWants& wants);

private:
    std::unique_ptr<SsimPyramid> pyramid_; // its memory serves one channel after the other
};

/// Of a single pair of planes.
SsimFigures measureSsim(const SsimPlanes& planes, const SsimWants& wants);

} // namespace rt
