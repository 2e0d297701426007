#include "tests/support/make_mesh.h"
#include "tools/rt-grid/brick_cost.h"
#include "tools/rt-grid/rebase_scene.h"
#include "tools/rt-grid/voxelize_triangle.h"

#include <gtest/gtest.h>

#include <numeric>

namespace rt {
namespace {

FreshArray<TriangleRecord> recordsOf(const Mesh& mesh) {
    return rebaseTriangles(mesh, Rebase{});
}

TEST(GridBrickCost, aSpreadForecastsHowManyVoxelsTrianglesMeet) {
    for (const float size : {0.02f, 0.1f, 0.3f}) {
        const auto records = recordsOf(test::moved(test::makeRandomTriangles(400, 7, size), 1.0f, {1, 1, 1}));
        for (const float side : {4.0f, 16.0f, 64.0f}) {
            double forecast = 0.0;
            double met = 0.0;
            for (const TriangleRecord& record : records) {
                const Spread spread = Spread::of(record, glm::vec3(side));
                EXPECT_NEAR(spread.references(1.0), 1.0, 1e-5);
                forecast += 1.0 / spread.corners;
                const double scale = side;
                const VoxelTriangle corners =
                    voxelTriangle(glm::dvec3(record.v0) * scale, glm::dvec3(record.v1) * scale,
                                  glm::dvec3(record.v2) * scale);
                forEachVoxelOf(corners, glm::uvec3(1u << 20), 0.0, [&](std::uint32_t) { ++met; });
            }
            EXPECT_NEAR(met / forecast, 1.0, 0.05) << size << ", " << side;
        }
    }
}

// Bricks of `count` random triangles of about `size` voxels in one voxel.
int shiftOf(std::size_t count, float size, int level = 0, double wordCost = 0.009) {
    const auto records = recordsOf(test::makeRandomTriangles(count, 9, size * std::ldexp(1.0f, -level)));
    std::vector<std::uint32_t> list(count);
    std::iota(list.begin(), list.end(), 0u);
    return BrickCost(records, glm::vec3(1.0f), wordCost, 10).shiftFor(list, level);
}

TEST(GridBrickCost, bricksPartSmallTrianglesAndLeaveLargeOnesTogether) {
    EXPECT_GE(shiftOf(100, 0.02f), 2);
    EXPECT_LT(shiftOf(100, 8.0f), shiftOf(100, 0.02f));
    EXPECT_EQ(shiftOf(8, 8.0f, 3), 0);
}

TEST(GridBrickCost, dearWordsMakeSmallerBricks) {
    EXPECT_GT(shiftOf(200, 0.05f, 0, 0.002), shiftOf(200, 0.05f, 0, 0.05));
}

TEST(GridBrickCost, aLongListBecomesABrickHoweverDeepItIs) {
    EXPECT_GE(shiftOf(5000, 0.02f, 9), 1);
    EXPECT_EQ(shiftOf(5000, 0.02f, 10), 0) << "voxels would be finer than the finest level";
}

} // namespace
} // namespace rt
