#pragma once
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace rt {

/// Light from far away on all sides, as a picture.
///
/// The direction (x, y, z), of unit length and pointing away from the scene, is seen at
///     u = atan2(x, -z) / (2 pi) + 0.5,   v = acos(y) / pi
/// of the picture: +y is its top row, the middle column is -z, +x lies a quarter of the width right of that.
/// Pixel (column, row) covers [column, column + 1) / width by [row, row + 1) / height.
struct EnvironmentPicture {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<glm::vec3> pixels; ///< radiance, linear RGB, finite and not negative; row by row from the top
    std::string warning;           ///< of what was no light in its file; empty: nothing
};

/// Whether a name ends in .exr or .hdr, as an environment's does.
bool isEnvironmentFile(const std::string& name);

/// From the channels R, G, B or Y of an EXR, or from a Radiance HDR. What is negative or not finite becomes
/// 0. Throws Error{FileAccess}, Error{InvalidContent} or Error{LimitExceeded}.
EnvironmentPicture readEnvironment(const std::string& path);

/// The same light from all sides.
EnvironmentPicture evenEnvironment(const glm::vec3& radiance);

} // namespace rt
