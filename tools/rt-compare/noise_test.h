#pragma once
#include "tools/rt-compare/prepared_pair.h"

namespace rt {

struct NoiseOptions {
    bool on = false;
    double level = 1e-3; ///< probability of a false alarm
};

/// Whether two renders with different seeds differ by more than their noise. Two tests, each at half the
/// level:
///
/// 1. Pixel by pixel, of the first part's luminance: z = difference / its standard deviation, which comes
/// from the
///    pictures' `variance` channels (the variance of a pixel's mean; of one picture's, where
///    `samplesPerPixel` of both is known) or from the second seed's render, pooled over 7x7 pixels. Its
///    probability is Student's with samples - 1 degrees of freedom (Welch 1947: no fewer). All pixels
///    together: Benjamini & Hochberg 1995. With a second seed, outliers count only where they are more than
///    the second render has itself against the other two, by a sign test: what any seed may do is no fault.
///    What is farther from both other renders than these are anywhere by a factor that no noise reaches is.
/// 2. Region by region, of every channel of numbers: d = a - b is symmetric round 0 if noise alone makes the
///    difference, however heavy its tails, as long as both took as many samples. So the sums D over squares
///    of 8x8 pixels have T = sum D / sqrt(sum D^2) with P(|T| >= t) <= 2 exp(-t^2 / 2) (Efron 1969, after
///    Hoeffding 1963), if the noise of one square does not depend on that of another: pictures that were
///    blurred or denoised are not for this test. Regions of 64, 128, ... pixels a side, up to the whole
///    picture; all together: Bonferroni.
///
/// 3. Square by square of 8x8 pixels: where at least 9 tenths of a value are lost or gained, noise does so in
///    either picture as often, so n such pixels of one square all in the same one have P <= 2^(1-n). What is
///    a thousandth of the level over all squares counts as a region.
///
/// Channels that differ without anything to tell the noise of single pixels do not pass, nor do those that
/// have too few squares for the second test to tell anything.
/// Differences below 2^-16 of the values are rounding and count as none.
/// Throws Error{InvalidContent} if the second render does not fit.
NoiseTest testNoise(const PreparedPair& pair, const NoiseOptions& options, const Picture* second);

} // namespace rt
