#pragma once
#include "tools/rt-compare/float_lanes.h"

namespace rt {

/// Eight colours, one lane each.
struct FloatsTriple {
    Floats x, y, z;
};

/// CIE XYZ of linear sRGB, divided by that of white: rows sum to 1, so that grey stays exactly without
/// colour. From the sRGB primaries and D65 as fractions of whole numbers.
inline constexpr double kXyzFromRgb[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

/// The matrices of FLIP's colour spaces, and the largest difference of two colours in them.
struct FlipColors {
    float relativeXyzFromRgb[3][3]; ///< XYZ over that of white
    float rgbFromRelativeXyz[3][3];
    float largestDifference; ///< of green and blue, to the power of kColorExponent

    FlipColors();
};

inline constexpr float kColorExponent = 0.7f;

inline FloatsTriple transformed(const float (&m)[3][3], const FloatsTriple& v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

/// Y, Cx, Cz: linear in light, so that they can be filtered.
inline FloatsTriple opponentOf(const FlipColors& colors, const FloatsTriple& rgb) {
    const FloatsTriple xyz = transformed(colors.relativeXyzFromRgb, rgb);
    return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

inline Floats labCurve(const Floats& t) {
    constexpr float kEdge = 6.0f / 29.0f;
    const Floats line = t * (1.0f / (3.0f * kEdge * kEdge)) + 4.0f / 29.0f;
    return t > kEdge * kEdge * kEdge ? cubeRoot(t) : line;
}

/// L*a*b* of a linear colour from 0 to 1, a* and b* weakened in the dark as the Hunt effect has it.
inline FloatsTriple huntLabOf(const FlipColors& colors, const FloatsTriple& rgb) {
    const FloatsTriple xyz = transformed(colors.relativeXyzFromRgb, rgb);
    const Floats fx = labCurve(xyz.x), fy = labCurve(xyz.y), fz = labCurve(xyz.z);
    const Floats lightness = 116.0f * fy - 16.0f, hunt = 0.01f * lightness;
    return {lightness, hunt * (500.0f * (fx - fy)), hunt * (200.0f * (fy - fz))};
}

inline FloatsTriple huntLabOfOpponent(const FlipColors& colors, const FloatsTriple& c) {
    const Floats y = (c.x + 16.0f) * (1.0f / 116.0f);
    const FloatsTriple xyz{y + c.y * (1.0f / 500.0f), y, y - c.z * (1.0f / 200.0f)};
    const FloatsTriple rgb = transformed(colors.rgbFromRelativeXyz, xyz);
    return huntLabOf(colors, {clampToUnit(rgb.x), clampToUnit(rgb.y), clampToUnit(rgb.z)});
}

/// Distance of two L*a*b* colours for large differences. Source: Abasi et al. 2020, HyAB.
inline Floats hyAb(const FloatsTriple& a, const FloatsTriple& b) {
    const Floats da = a.y - b.y, db = a.z - b.z;
    return absolute(a.x - b.x) + squareRoot(da * da + db * db);
}

/// Linear light of eight sRGB values from 0 to 1.
inline Floats decodedSrgb(const Floats& encoded) {
    const Floats curve = power((encoded + 0.055f) * (1.0f / 1.055f), allFloats(2.4f));
    return encoded <= 0.04045f ? encoded * (1.0f / 12.92f) : curve;
}

/// Narkowicz 2015 with the factor 0.6 that cancels its built-in exposure, as HDR-FLIP takes it: numerator
/// and denominator as polynomials, from the constant on.
inline constexpr float kAcesAbove[3] = {0.0f, 0.6f * 0.03f, 0.36f * 2.51f};
inline constexpr float kAcesBelow[3] = {0.14f, 0.6f * 0.59f, 0.36f * 2.43f};

inline Floats acesToneMapped(const Floats& v) {
    return v * (kAcesAbove[1] + v * kAcesAbove[2]) /
           (kAcesBelow[0] + v * (kAcesBelow[1] + v * kAcesBelow[2]));
}

} // namespace rt
