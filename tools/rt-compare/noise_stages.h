#pragma once
#include "tools/rt-compare/prepared_pair.h"

namespace rt {

/// Of the values: differences below are rounding.
inline constexpr double kNoiseRounding = 0x1p-16;

/// The first test of testNoise(), at this level.
void testPixelNoise(const PreparedPair& pair, double level, const Picture* second, NoiseTest& result);

/// The second and third ones, at this level together.
void testRegionNoise(const PreparedPair& pair, double level, NoiseTest& result);

} // namespace rt
