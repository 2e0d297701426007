#pragma once
#include "formats/environment_picture.h"

#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace rt {

/// An EnvironmentPicture, and how its light is distributed.
struct EnvironmentMap {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<glm::vec3> pixels; ///< radiance, linear RGB, finite and not negative; row by row from the top
    /// The piecewise constant distribution of luminance * sin(pi v), v in the middle of the row, over the
    /// unit square of (u, v): floats, one after the other, as the shaders read them (environmentRow())
    ///     [0]  width
    ///     [1]  height
    ///     [2]  integral over the unit square; 0 = all is black
    ///     [3]  height + 1 values: part of the light above each border of rows, 0 ... 1
    ///     then for each row width + 1 values: part of the row's light left of each border of columns, 0 ...
    ///     1
    /// Where there is no light at all, rows or columns get even parts. The density over directions is
    /// luminance / (integral * 2 pi^2) in each pixel, but for sin(pi v) of the direction over that of the
    /// row. Source: Pharr, Jakob & Humphreys, "Physically Based Rendering", 13.6.7 and 14.2.4.
    std::vector<float> cdf;
};

/// Throws Error{Usage} unless --environment names a file or a colour.
void checkEnvironment(const std::string& text);

/// Of readEnvironment(), or of one colour, "G" or "R,G,B". Throws Error{Usage}, Error{FileAccess},
/// Error{InvalidContent} or Error{LimitExceeded}.
EnvironmentMap loadEnvironment(const std::string& text);
EnvironmentMap mapOf(EnvironmentPicture picture);

/// EnvironmentMap::cdf of such pixels.
std::vector<float> environmentCdf(unsigned width, unsigned height, const std::vector<glm::vec3>& pixels);

} // namespace rt
