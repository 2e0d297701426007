#include "tests/bench/embree_tracer.h"
#include "tests/bench/hit_check.h"
#include "tests/support/make_mesh.h"

#include <gtest/gtest.h>

#include <bit>

namespace rt::bench {
namespace {

QueryHit hitAt(float t, std::uint32_t triangle) {
    return {{std::bit_cast<std::uint32_t>(t), 0u, 0u, triangle}};
}

const QueryHit kMiss = hitAt(-1.0f, kNoTriangle);
// Of size 1 + 4 at t = 4.
const QueryRay kRay{{1.0f, 0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f, 1e30f}};

HitCounts compareOne(const QueryHit& expected, const QueryHit& got, bool anyHit = false) {
    return compareHits({{&kRay, 1}, {&expected, 1}, {&got, 1}, anyHit});
}

TEST(HitCheck, EveryPairOfHitsHasItsClass) {
    EXPECT_EQ(compareOne(kMiss, kMiss)[HitClass::Agree], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.00002f, 7))[HitClass::Agree], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.001f, 7))[HitClass::Grazing], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.1f, 7))[HitClass::Wrong], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.000002f, 8))[HitClass::Tie], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.0000045f, 8))[HitClass::NearTie], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(4.001f, 8))[HitClass::Wrong], 1u);
    EXPECT_EQ(compareOne(hitAt(4.0f, 7), kMiss)[HitClass::Lost], 1u);
    EXPECT_EQ(compareOne(kMiss, hitAt(4.0f, 7))[HitClass::Extra], 1u);
}

TEST(HitCheck, AnyHitComparesHitAndMissOnly) {
    EXPECT_EQ(compareOne(hitAt(0.0f, 0), hitAt(4.0f, 7), true)[HitClass::Agree], 1u);
    EXPECT_EQ(compareOne(hitAt(0.0f, 0), kMiss, true)[HitClass::Lost], 1u);
    EXPECT_EQ(compareOne(kMiss, hitAt(4.0f, 7), true)[HitClass::Extra], 1u);
}

TEST(HitCheck, RecordsThatMakeNoSenseAreWrong) {
    for (const bool anyHit : {false, true}) {
        EXPECT_EQ(compareOne(kMiss, hitAt(4.0f, kNoTriangle), anyHit)[HitClass::Wrong], 1u);
        EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(-1.0f, 7), anyHit)[HitClass::Wrong], 1u);
        EXPECT_EQ(compareOne(hitAt(4.0f, 7), hitAt(std::nanf(""), 7), anyHit)[HitClass::Wrong], 1u);
        for (const int weight : {1, 2}) { // u and v
            QueryHit hit = hitAt(4.0f, 7);
            hit.tuvId[weight] = std::bit_cast<std::uint32_t>(std::nanf(""));
            EXPECT_EQ(compareOne(hitAt(4.0f, 7), hit, anyHit)[HitClass::Wrong], 1u);
        }
    }
}

TEST(HitCheck, OnlyFaultsAreListed) {
    const std::vector<QueryRay> rays(3, kRay);
    const std::vector<QueryHit> expected = {hitAt(4.0f, 7), hitAt(4.0f, 7), kMiss};
    const std::vector<QueryHit> got = {kMiss, hitAt(4.0f, 7), hitAt(1.0f, 2)};
    const HitCounts counts = compareHits({rays, expected, got});
    EXPECT_EQ(counts.rays, 3u);
    EXPECT_EQ(counts.hits, 2u);
    EXPECT_EQ(counts.faults, (std::vector<std::size_t>{0, 2}));
}

// Two rays along -z at the unit cube: one along its right side, one through the diagonal of its front.
TEST(HitCheck, SilhouettesAreExcusedButHolesInASurfaceAreNot) {
    const Mesh cube = test::makeCube();
    const EmbreeTracer tracer(cube, EmbreeMode::Robust, 1);
    const std::vector<QueryRay> rays = {{{0.5f, 0.1f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}},
                                        {{0.25f, 0.25f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}}};
    for (const bool anyHit : {false, true}) {
        const std::vector<QueryHit> expected = tracer.trace(rays, anyHit, 1).hits;
        ASSERT_NE(expected[1].tuvId.w, kNoTriangle);
        const bool sideIsHit = expected[0].tuvId.w != kNoTriangle;
        const std::vector<QueryHit> got = {sideIsHit ? kMiss : hitAt(1.5f, 0), kMiss};
        const TracedRays traced{rays, expected, got, anyHit};
        HitCounts counts = compareHits(traced);
        EXPECT_EQ(counts.faults.size(), 2u);
        excuseEdges(tracer, traced, counts);
        EXPECT_EQ(counts[HitClass::Edge], 1u);
        EXPECT_EQ(counts[HitClass::Lost], 1u);
        EXPECT_EQ(counts[HitClass::Extra], 0u);
        EXPECT_EQ(counts.faults, std::vector<std::size_t>{1});
    }
}

// The expected distance, but of a triangle or at a point of it where the ray is not.
TEST(HitCheck, HitsThatContradictThemselvesAreWrong) {
    const Mesh cube = test::makeCube();
    const EmbreeTracer tracer(cube, EmbreeMode::Robust, 1);
    const std::vector<QueryRay> rays(6, {{0.2f, 0.1f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}});
    const std::vector<QueryHit> expected = tracer.trace(rays, false, 1).hits;
    const std::uint32_t triangle = expected[0].tuvId.w;
    std::vector<QueryHit> got = expected;
    got[1].tuvId.w = triangle == 0 ? 5 : 0;
    got[2].tuvId.w = static_cast<std::uint32_t>(cube.triangles.size());
    got[3].tuvId.y = std::bit_cast<std::uint32_t>(std::bit_cast<float>(got[3].tuvId.y) + 1e-3f);
    got[4].tuvId.z = std::bit_cast<std::uint32_t>(std::bit_cast<float>(got[4].tuvId.z) + 1e-7f);
    got[5].tuvId.x = std::bit_cast<std::uint32_t>(std::bit_cast<float>(got[5].tuvId.x) + 1e-3f);
    for (const bool anyHit : {false, true}) {
        const TracedRays traced{rays, expected, got, anyHit};
        HitCounts counts = compareHits(traced);
        EXPECT_TRUE(counts.faults.empty());
        EXPECT_EQ(counts[HitClass::Grazing], anyHit ? 0u : 1u);
        findDisplaced(cube, traced, counts);
        EXPECT_EQ(counts[HitClass::Wrong], anyHit ? 0u : 4u);
        EXPECT_EQ(counts.faults,
                  anyHit ? std::vector<std::size_t>{} : (std::vector<std::size_t>{1, 2, 3, 5}));
        EXPECT_EQ(counts[HitClass::Agree], anyHit ? 6u : 2u);
        EXPECT_EQ(counts[HitClass::Tie], 0u);
    }
}

TEST(HitCheck, AHitBehindTheEndOfTheWorldIsWrong) {
    const Mesh cube = test::makeCube();
    const EmbreeTracer tracer(cube, EmbreeMode::Robust, 1);
    const std::vector<QueryRay> rays = {{{0.2f, 0.1f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}}};
    const std::vector<QueryHit> expected = tracer.trace(rays, false, 1).hits, got = {hitAt(1e30f, 0)};
    const TracedRays traced{rays, expected, got, false};
    HitCounts counts = compareHits(traced);
    excuseEdges(tracer, traced, counts);
    EXPECT_EQ(counts[HitClass::Wrong], 1u);
}

// A steep wedge seen past its edge: where a ray just beside the edge meets the front, one that rounding took
// to the edge itself may have met the back.
TEST(HitCheck, TheBackOfASilhouetteIsExcused) {
    const glm::vec3 below(0.0f, -1.0f, 0.0f), above(0.0f, 1.0f, 0.0f);
    const Mesh wedge =
        test::makeTriangles({below, above, {-0.1f, 0.0f, 0.5f}, below, above, {-0.1f, 0.0f, -0.5f}});
    const EmbreeTracer tracer(wedge, EmbreeMode::Robust, 1);
    const std::vector<QueryRay> rays = {{{1e-7f, 0.1f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}}};
    const std::vector<QueryHit> expected = tracer.trace(rays, false, 1).hits;
    ASSERT_EQ(expected[0].tuvId.w, kNoTriangle);
    for (const bool atEdge : {true, false}) {
        const std::vector<QueryHit> got = {hitAt(atEdge ? 2.0f : 2.01f, 1)};
        const TracedRays traced{rays, expected, got, false};
        HitCounts counts = compareHits(traced);
        excuseEdges(tracer, traced, counts);
        EXPECT_EQ(counts[HitClass::Edge], atEdge ? 1u : 0u);
    }
}

} // namespace
} // namespace rt::bench
