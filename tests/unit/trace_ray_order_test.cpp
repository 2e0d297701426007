// Which batches of rays count as scattered.
#include "tools/rt-trace/ray_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace rt {
namespace {

// 100 voxels of 0.01 along x; atlas space is world space times 4: a scene 0.25 long.
GridParams quarterUnitScene() {
    GridParams grid{};
    grid.dims = glm::uvec4(100, 10, 10, kStructureNested);
    grid.cellSize = glm::vec4(0.01f, 0.01f, 0.01f, 0.0f);
    grid.worldOffset = glm::vec4(0.0f, 0.0f, 0.0f, 4.0f);
    return grid;
}

std::vector<QueryRay> pinholeRays(std::size_t count) {
    std::vector<QueryRay> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = static_cast<float>(i) / static_cast<float>(count) - 0.5f;
        rays.push_back({glm::vec4(5.0f, 6.0f, 7.0f, 0.0f), glm::vec4(x, 0.1f, 1.0f, 1e30f)});
    }
    return rays;
}

bool areScattered(const std::vector<QueryRay>& rays) {
    return rt::areScattered(rays, quarterUnitScene());
}

TEST(RayOrder, RaysOfAPinholeAreCoherentInOrder) {
    EXPECT_FALSE(areScattered(pinholeRays(100000)));
}

TEST(RayOrder, ShuffledRaysAreScattered) {
    std::vector<QueryRay> rays = pinholeRays(100000);
    std::shuffle(rays.begin(), rays.end(), std::mt19937(1));
    EXPECT_FALSE(areScattered(rays)); // all within 53 degrees
    for (std::size_t i = 0; i < rays.size(); i += 2) rays[i].directionTmax.z = 0.0f;
    EXPECT_TRUE(areScattered(rays));
}

TEST(RayOrder, ParallelRaysFromAllOverTheSceneAreScattered) {
    std::vector<QueryRay> rays(64 * 100);
    for (std::size_t i = 0; i < rays.size(); ++i)
        rays[i] = {glm::vec4(0.03f * static_cast<float>(i % 2), 0.0f, 0.0f, 0.0f),
                   glm::vec4(0.0f, 0.0f, 1.0f, 1.0f)};
    EXPECT_FALSE(areScattered(rays)); // 0.03 apart, an eighth of 0.25 is a little more
    for (QueryRay& ray : rays) ray.originTmin.x *= 1.1f;
    EXPECT_TRUE(areScattered(rays));
}

TEST(RayOrder, MostRunsDecide) {
    std::vector<QueryRay> rays = pinholeRays(3200);
    const auto scatterRuns = [&](std::size_t runs) {
        for (std::size_t i = 0; i < runs * 32; i += 2)
            rays[i].directionTmax = glm::vec4(0.0f, 0.0f, -1.0f, 1.0f);
    };
    scatterRuns(50);
    EXPECT_FALSE(areScattered(rays));
    scatterRuns(51);
    EXPECT_TRUE(areScattered(rays));
}

TEST(RayOrder, FewRaysAndRaysThatGoNowhereAreCoherent) {
    EXPECT_FALSE(areScattered({}));
    std::vector<QueryRay> rays = pinholeRays(31);
    for (std::size_t i = 0; i < rays.size(); i += 2) rays[i].directionTmax.z = -1.0f;
    EXPECT_FALSE(areScattered(rays));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    rays.assign(96, {glm::vec4(0.0f), glm::vec4(nan, 0.0f, 0.0f, 1.0f)});
    std::fill(rays.begin() + 32, rays.begin() + 64, QueryRay{glm::vec4(infinity), glm::vec4(1.0f)});
    std::fill(rays.begin() + 64, rays.end(), QueryRay{glm::vec4(0.0f), glm::vec4(0.0f)});
    EXPECT_FALSE(areScattered(rays));
}

} // namespace
} // namespace rt
