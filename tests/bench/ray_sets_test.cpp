#include "tests/bench/embree_tracer.h"
#include "tests/bench/ray_sets.h"
#include "tests/support/make_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

namespace rt::bench {
namespace {

const Camera kFromFront{{0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 45.0};

struct Scene {
    Mesh mesh = test::makeSphere(3);
    EmbreeTracer tracer{mesh, EmbreeMode::Robust, 1};
    std::vector<QueryRay> primary = primaryRays(kFromFront, 64);
    std::vector<QueryHit> hits = tracer.trace(primary, false, 1).hits;

    std::size_t hitCount() const {
        return static_cast<std::size_t>(std::count_if(
            hits.begin(), hits.end(), [](const QueryHit& hit) { return hit.tuvId.w != kNoTriangle; }));
    }
};

glm::vec3 origin(const QueryRay& ray) {
    return glm::vec3(ray.originTmin);
}

glm::vec3 direction(const QueryRay& ray) {
    return glm::vec3(ray.directionTmax);
}

bool same(const QueryRay& a, const QueryRay& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(RaySets, ThirtyTwoPrimaryRaysInARowAreATileOfEightByFourPixels) {
    const std::vector<QueryRay> rays = primaryRays(kFromFront, 16);
    ASSERT_EQ(rays.size(), 256u);
    for (std::size_t first = 0; first < rays.size(); first += 32) {
        std::set<float> columns, rows;
        for (std::size_t i = first; i < first + 32; ++i) {
            columns.insert(std::round(1e4f * direction(rays[i]).x / direction(rays[i]).z));
            rows.insert(std::round(1e4f * direction(rays[i]).y / direction(rays[i]).z));
        }
        EXPECT_EQ(columns.size(), 8u) << first;
        EXPECT_EQ(rows.size(), 4u) << first;
    }
    EXPECT_LT(direction(rays[0]).x, direction(rays[1]).x);
    EXPECT_GT(direction(rays[0]).y, direction(rays[8]).y) << "the first row is the top one";
    EXPECT_LT(direction(rays[0]).x, direction(rays[32]).x) << "the second tile is right of the first";
}

TEST(RaySets, ShadowRaysReachTheLightAtOneAndStartOnItsSide) {
    const Scene scene;
    const glm::dvec3 light(3.0, 5.0, 1.0);
    const std::vector<QueryRay> rays = shadowRays(scene.mesh, scene.primary, scene.hits, light);
    ASSERT_EQ(rays.size(), scene.hitCount());
    const std::vector<QueryHit> found = scene.tracer.trace(rays, true, 1).hits;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_LT(glm::length(origin(rays[i]) + direction(rays[i]) - glm::vec3(light)), 1e-5f);
        EXPECT_EQ(rays[i].directionTmax.w, 0.9999f);
        // A convex body shadows a point only by its own other side, never by the triangle that the point is
        // on.
        const bool faces = glm::dot(origin(rays[i]), glm::normalize(direction(rays[i]))) > 0.15f;
        if (faces) {
            EXPECT_EQ(found[i].tuvId.w, kNoTriangle) << i;
            ++lit;
        }
    }
    EXPECT_GT(lit, rays.size() / 4);
}

TEST(RaySets, DiffuseRaysAreCosineDistributedOnTheSideOfTheEye) {
    const Scene scene;
    const std::vector<QueryRay> rays = diffuseRays(scene.mesh, scene.primary, scene.hits);
    ASSERT_EQ(rays.size(), scene.hitCount());
    const std::vector<QueryHit> found = scene.tracer.trace(rays, false, 1).hits;
    double cosines = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(found[i].tuvId.w, kNoTriangle) << "nothing lies outside a convex body";
        EXPECT_NEAR(glm::length(direction(rays[i])), 1.0f, 1e-6f);
        cosines += glm::dot(glm::normalize(origin(rays[i])), direction(rays[i]));
    }
    EXPECT_NEAR(cosines / static_cast<double>(rays.size()), 2.0 / 3.0, 0.02);
}

TEST(RaySets, ShufflingKeepsTheRaysAndAlwaysGivesTheSameOrder) {
    const std::vector<QueryRay> rays = primaryRays(kFromFront, 32);
    const std::vector<QueryRay> mixed = shuffled(rays);
    EXPECT_TRUE(std::equal(mixed.begin(), mixed.end(), shuffled(rays).begin(), same));
    EXPECT_TRUE(std::is_permutation(mixed.begin(), mixed.end(), rays.begin(), same));
    std::size_t inPlace = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) inPlace += same(rays[i], mixed[i]) ? 1 : 0;
    EXPECT_LT(inPlace, 10u);
}

} // namespace
} // namespace rt::bench
