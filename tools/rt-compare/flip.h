#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rt {

/// Red, green and blue of width*height pixels, row by row.
struct ColorPlanes {
    enum class Encoding { Linear, Srgb };
    std::uint32_t width = 0, height = 0;
    std::array<std::span<const float>, 3> planes;
    Encoding encoding = Encoding::Linear;
    std::size_t pixelCount() const { return std::size_t(width) * height; }
};

/// The stops by which a picture is exposed: `count` of them, evenly from `start` to `stop`.
struct ExposureRange {
    double start = 0.0, stop = 0.0;
    unsigned count = 1;
    /// The i-th factor: 2^(its stops).
    double factor(unsigned i) const;
};

/// An observer 0.7 m from a screen 0.7 m and 3840 pixels wide.
inline constexpr double kDefaultPixelsPerDegree = 67.0206432765823;

/// FLIP of two pictures as a screen shows them, values clamped to [0, 1]: width*height errors from 0 (no
/// difference is seen) to 1, the same for any number of threads. Values that are not finite count as 0; they
/// are another test's business.
/// Source: Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images".
std::vector<float> flipLdr(const ColorPlanes& reference, const ColorPlanes& test,
                           double pixelsPerDegree = kDefaultPixelsPerDegree);

/// The largest FLIP of two linear pictures over the exposures, each tone mapped by the ACES curve.
/// Source: Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images".
std::vector<float> flipHdr(const ColorPlanes& reference, const ColorPlanes& test,
                           const ExposureRange& exposures, double pixelsPerDegree = kDefaultPixelsPerDegree);

struct AutomaticExposures {
    ExposureRange range;
    std::string note; ///< what stood in for the paper's rule; empty: nothing did
};

/// From the exposure at which the reference's brightest pixel comes out at 0.85 to that at which its median
/// does, about a stop apart. Where the paper's rule breaks down it still gives exposures in which something
/// is seen: the median is that of the pixels brighter than a bright one / 2^32 if the one of all pixels is
/// darker (a black background; bright are the brightest but for a thousandth of the pixels, which may have
/// gone wrong); a black reference leaves the choice to the test picture; two black pictures
/// get the exposure 0. At most 33 exposures, more than a stop apart if need be.
AutomaticExposures automaticExposures(const ColorPlanes& reference, const ColorPlanes& test);

/// Whether any pixel is neither black nor white at any of the exposures.
bool showsAnything(const ColorPlanes& picture, const ExposureRange& exposures);

} // namespace rt
