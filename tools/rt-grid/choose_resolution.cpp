#include "tools/rt-grid/choose_resolution.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace rt {
namespace {

glm::uvec3 cubicVoxels(const glm::dvec3& extent, double cellSize, double maxSide) {
    glm::uvec3 dims;
    for (int axis = 0; axis < 3; ++axis)
        dims[axis] = static_cast<unsigned>(std::clamp(std::round(extent[axis] / cellSize), 1.0, maxSide));
    return dims;
}

// Side of the cubes of which `voxels` fill the box, where an axis thinner than a cube counts as one cube.
double cubeSide(const glm::dvec3& extent, double voxels) {
    std::array<double, 3> e{extent.x, extent.y, extent.z};
    std::sort(e.begin(), e.end(), std::greater<>());
    const double inSpace = std::cbrt(e[0] * e[1] * e[2] / voxels);
    if (inSpace <= e[2]) return inSpace;
    const double inPlane = std::sqrt(e[0] * e[1] / voxels);
    if (inPlane <= e[1]) return inPlane;
    return e[0] / voxels;
}

} // namespace

glm::uvec3 chooseResolution(const glm::dvec3& extent, std::size_t triangleCount,
                            const ResolutionRequest& request) {
    const unsigned largest =
        std::max({request.exact.x, request.exact.y, request.exact.z, request.longestSide});
    if (largest > kMaxRequestedSide)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("--resolution asks for {} voxels along one axis; at most {} are possible; lower it",
                        largest, kMaxRequestedSide));
    if (request.exact != glm::uvec3(0u)) return request.exact;
    if (request.longestSide > 0) {
        const double longest = std::max({extent.x, extent.y, extent.z});
        return cubicVoxels(extent, longest / request.longestSide, request.longestSide);
    }
    const double voxels =
        std::clamp(request.voxelsPerTriangle * static_cast<double>(triangleCount), 1.0, kMaxAutomaticVoxels);
    return cubicVoxels(extent, cubeSide(extent, voxels), kMaxAutomaticSide);
}

} // namespace rt
