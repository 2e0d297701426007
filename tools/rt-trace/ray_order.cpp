#include "tools/rt-trace/ray_order.h"

#include "common/bounds.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace rt {
namespace {

constexpr std::size_t kRun = 32;
constexpr std::size_t kMostRuns = 1024;

// Rays that go nowhere have no say.
bool runIsTogether(std::span<const QueryRay> run, double farApart) {
    BoundsD origins;
    glm::dvec3 sum(0);
    double count = 0;
    for (const QueryRay& ray : run) {
        const glm::dvec3 origin(ray.originTmin), direction(ray.directionTmax);
        const double length = glm::length(direction);
        if (!(length > 0.0) || !(glm::length(origin) + length < 1e300)) continue;
        origins.add(origin);
        sum += direction / length;
        count += 1.0;
    }
    if (count == 0.0) return true;
    const glm::dvec3 extent = origins.extent();
    return std::max({extent.x, extent.y, extent.z}) <= farApart && glm::length(sum) >= 0.9 * count;
}

} // namespace

bool areScattered(std::span<const QueryRay> rays, const GridParams& grid) {
    const glm::dvec3 size = glm::dvec3(grid.dims) * glm::dvec3(grid.cellSize) / double(grid.worldOffset.w);
    const double farApart = std::max({size.x, size.y, size.z}) / 8.0;
    const std::size_t runs = rays.size() / kRun;
    const std::size_t stride = (runs + kMostRuns - 1) / kMostRuns;
    std::size_t together = 0, apart = 0;
    for (std::size_t run = 0; run < runs; run += stride)
        ++(runIsTogether(rays.subspan(run * kRun, kRun), farApart) ? together : apart);
    return apart > together;
}

} // namespace rt
