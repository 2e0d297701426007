#pragma once

namespace rt {

// What a picture holds beside R, G, B and A.
inline constexpr unsigned kAovDepth = 1u << 0;    // Z
inline constexpr unsigned kAovNormal = 1u << 1;   // N.X, N.Y, N.Z
inline constexpr unsigned kAovPosition = 1u << 2; // P.X, P.Y, P.Z
inline constexpr unsigned kAovAlbedo = 1u << 3;   // albedo.R, albedo.G, albedo.B
inline constexpr unsigned kAovId = 1u << 4;       // id
inline constexpr unsigned kAovTexcoord = 1u << 5; // uv.U, uv.V
inline constexpr unsigned kAovSteps = 1u << 6;    // steps
inline constexpr unsigned kAovTests = 1u << 7;    // tests
inline constexpr unsigned kAovVariance = 1u << 8; // variance
inline constexpr unsigned kAovMaterial = 1u << 9; // material
inline constexpr unsigned kAovTime = 1u << 10;    // time

inline constexpr unsigned kDefaultAovs = kAovDepth | kAovNormal | kAovId;
/// Those of `--aov all`: the same from run to run, so without the time.
inline constexpr unsigned kAllAovs = (1u << 10) - 1;

/// What a pixel's first sample sees; the others are means over its samples, but for the variance.
inline constexpr unsigned kFirstSampleAovs =
    kAovDepth | kAovNormal | kAovPosition | kAovId | kAovTexcoord | kAovMaterial;

/// Those that need images of their own on the device, all together.
inline constexpr unsigned kExtraAovs =
    kAovPosition | kAovAlbedo | kAovTexcoord | kAovSteps | kAovTests | kAovTime;

} // namespace rt
