// Precisions and triangle tests of ray queries.
#include "tests/gpu/exact_hit.h"
#include "tests/gpu/trace_fixture.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt {
namespace {

constexpr unsigned kTests[] = {kIntersectWatertight, kIntersectMollerTrumbore, kIntersectBaldwinWeber};

class Precision : public test::OnGpu {
protected:
    const Mesh soup_ = test::makeRandomTriangles(300, 5, 0.15f);
    const std::vector<QueryRay> rays_ = test::randomRays(soup_, 3000);

    test::ExactHit exactOf(const QueryHitDouble& hit, std::size_t ray) const {
        return test::intersectExactly(soup_, hit.triangle, rays_[ray]);
    }
};

TEST_F(Precision, DoubleAgreesWithBruteForceToTwelveDigits) {
    for (const std::uint32_t structure : {kStructureCloud, kStructureNested}) {
        const auto hits = test::traceDouble(*context, test::makeAtlas(soup_, structure, {7, 8, 9}), rays_);
        std::size_t found = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (hits[i].triangle == kNoTriangle) {
                EXPECT_EQ(hits[i].t, -1.0);
                continue;
            }
            const test::ExactHit exact = exactOf(hits[i], i);
            const double scale = 1.0 + exact.weightError * 1e7; // of triangles seen edge on
            EXPECT_NEAR(hits[i].t, exact.t, 1e-12 * scale * (1.0 + exact.t));
            EXPECT_NEAR(hits[i].u, exact.u, 1e-12 * scale);
            EXPECT_NEAR(hits[i].v, exact.v, 1e-12 * scale);
            ++found;
        }
        EXPECT_GT(found, 1000u);
    }
}

// Where no rounding decides, all find what the reference finds, with the error of their precision.
TEST_F(Precision, EveryTestFindsTheReferencesHitsAwayFromEdges) {
    const Atlas atlas = test::makeAtlas(soup_, kStructureNested, {7, 8, 9});
    const auto reference = test::traceDouble(*context, atlas, rays_);
    for (const unsigned intersect : kTests) {
        const test::QuerySettings settings{.limits = {}, .intersect = intersect};
        const auto hits = test::traceQuery(*context, atlas, rays_, settings);
        const auto doubles = test::traceDouble(*context, atlas, rays_, settings);
        std::size_t other = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            EXPECT_EQ(doubles[i].triangle == kNoTriangle, doubles[i].t == -1.0);
            if (hits[i].tuvId.w != reference[i].triangle || doubles[i].triangle != reference[i].triangle) {
                ++other;
            } else if (reference[i].triangle != kNoTriangle) {
                EXPECT_NEAR(std::bit_cast<float>(hits[i].tuvId.x), reference[i].t,
                            1e-3 * reference[i].t + 1e-4);
                EXPECT_NEAR(doubles[i].t, reference[i].t, 1e-3 * reference[i].t + 1e-4);
            }
        }
        EXPECT_LE(other, 3u) << "test " << intersect;
    }
}

TEST_F(Precision, OnlyTheWatertightTestKeepsEveryRayInASphere) {
    const Mesh sphere = test::makeSphere(4);
    const Atlas atlas = test::makeAtlas(sphere, kStructureNested, {9, 8, 7});
    const auto rays = test::raysAtVerticesAndEdges(sphere, {0.1f, -0.2f, 0.05f});
    for (const unsigned intersect : kTests) {
        const auto hits = test::traceQuery(*context, atlas, rays, {.limits = {}, .intersect = intersect});
        const auto lost = std::count_if(hits.begin(), hits.end(),
                                        [](const QueryHit& hit) { return hit.tuvId.w == kNoTriangle; });
        if (intersect == kIntersectWatertight)
            EXPECT_EQ(lost, 0);
        else
            EXPECT_GT(lost, 0) << "test " << intersect << ": a check that cannot fail";
    }
    const auto doubles = test::traceDouble(*context, atlas, rays);
    EXPECT_EQ(std::count_if(doubles.begin(), doubles.end(),
                            [](const QueryHitDouble& hit) { return hit.triangle == kNoTriangle; }),
              0);
}

} // namespace
} // namespace rt
