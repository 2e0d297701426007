#pragma once
#include <array>
#include <glm/vec3.hpp>

namespace rt {

/// How radiances become what a screen shows.
enum class ToneMap {
    None,     ///< values above 1 are cut off
    Reinhard, ///< Reinhard et al. 2002, on the luminance
    Aces,     ///< Narkowicz 2015, "ACES Filmic Tone Mapping Curve"
    Filmic,   ///< Hable 2010, "Filmic Tonemapping Operators"; 11.2 becomes white
};

/// In the order of the enumerators.
inline constexpr std::array<const char*, 4> kToneMapNames = {"none", "reinhard", "aces", "filmic"};

/// A linear colour in, one for sRGB encoding out, which still needs clamping to [0, 1].
glm::dvec3 toneMapped(ToneMap map, const glm::dvec3& linear);

/// 0.2126 R + 0.7152 G + 0.0722 B.
double luminanceOf(const glm::dvec3& linear);

} // namespace rt
