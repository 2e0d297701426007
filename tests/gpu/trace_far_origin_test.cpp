// A ray from far away must see the first surface, although the time of its entry into the grid is rounded.
#include "tests/gpu/trace_fixture.h"

#include <bit>
#include <random>

namespace rt {
namespace {

// Towards the wall x = 0 of the unit cube, from `distance` away.
std::vector<QueryRay> raysFromFar(float distance, std::size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> inWall(0.2f, 0.8f), slope(-0.5f, 0.5f);
    std::vector<QueryRay> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 direction = glm::normalize(glm::vec3(1.0f, slope(random), slope(random)));
        const glm::vec3 target(0.0f, inWall(random), inWall(random));
        rays.push_back({glm::vec4(target - distance * direction, 0.0f), glm::vec4(direction, 1e30f)});
    }
    return rays;
}

class FarOrigin : public test::OnGpu, public testing::WithParamInterface<float> {};

TEST_P(FarOrigin, FirstWallIsHit) {
    const float distance = GetParam();
    const Mesh box = test::makeBox(glm::vec3(0.0f), glm::vec3(1.0f));
    const std::vector<QueryRay> rays = raysFromFar(distance, 20000);
    for (const std::uint32_t structure : {kStructureUniform, kStructureCloud}) {
        // Voxels so thin along x that a few roundings of the distance skip the one that holds the wall.
        const Atlas atlas = test::makeAtlas(box, structure, {2048, 1, 1});
        const std::vector<QueryHit> hits = test::traceQuery(*context, atlas, rays);
        int seenThrough = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].tuvId.w == kNoTriangle) continue; // past the wall's edge: the origin is rounded too
            const float t = std::bit_cast<float>(hits[i].tuvId.x);
            seenThrough += rays[i].originTmin.x + double(t) * rays[i].directionTmax.x > 0.3;
        }
        EXPECT_EQ(seenThrough, 0) << "structure " << structure;
    }
}

INSTANTIATE_TEST_SUITE_P(Distances, FarOrigin, testing::Values(2.0f, 100.0f, 1e4f, 1e5f));

} // namespace
} // namespace rt
