// Ray queries against brute force in double precision, and rays that are hard to trace.
#include "tests/gpu/exact_hit.h"
#include "tests/gpu/trace_fixture.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace rt {
namespace {

using test::ExactHit;
using test::intersectExactly;
using test::randomRays;
using test::rayFrom;
using test::raysAtVerticesAndEdges;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kDenormal = 1e-40f;

float distanceOf(const QueryHit& hit) {
    return std::bit_cast<float>(hit.tuvId.x);
}
glm::dvec2 weightsOf(const QueryHit& hit) {
    return {std::bit_cast<float>(hit.tuvId.y), std::bit_cast<float>(hit.tuvId.z)};
}
bool isMiss(const QueryHit& hit) {
    return hit.tuvId.w == kNoTriangle;
}

bool sameBytes(const std::vector<QueryHit>& a, const std::vector<QueryHit>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(QueryHit)) == 0;
}

bool isWithin(double t, const QueryRay& query, double slack) {
    return t >= query.originTmin.w - slack * std::abs(t) && t <= query.directionTmax.w * (1.0 + slack);
}

constexpr double kEdge = 1e-5; // barycentric distance from an edge within which float and double may disagree
constexpr double kClose = 1e-5;  // relative difference of t, likewise
constexpr double kWeight = 1e-4; // difference of u and v, beside weightError

// The point that was found is on the triangle, and is where the ray meets it.
void expectSamePoint(const ExactHit& exact, const QueryHit& found) {
    EXPECT_GT(exact.margin, -kEdge);
    EXPECT_NEAR(distanceOf(found), exact.t, kClose * std::abs(exact.t) + 1e-6);
    EXPECT_NEAR(weightsOf(found).x, exact.u, kWeight + exact.weightError);
    EXPECT_NEAR(weightsOf(found).y, exact.v, kWeight + exact.weightError);
}

// Distance of the nearest hit that no rounding can take away; infinite if there is none.
double nearestCertainHit(const Mesh& mesh, const QueryRay& query) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const ExactHit hit = intersectExactly(mesh, i, query);
        if (hit.margin > kEdge && isWithin(hit.t, query, -kClose)) nearest = std::min(nearest, hit.t);
    }
    return nearest;
}

// A found hit must be a real one, with no certain hit nearer; a miss means that there is no certain hit.
void expectNearest(const Mesh& mesh, const QueryRay& query, const QueryHit& found) {
    const double nearest = nearestCertainHit(mesh, query);
    if (isMiss(found)) {
        EXPECT_EQ(nearest, std::numeric_limits<double>::infinity());
        EXPECT_EQ(distanceOf(found), -1.0f);
        EXPECT_EQ(glm::uvec2(found.tuvId.y, found.tuvId.z), glm::uvec2(0));
        return;
    }
    ASSERT_LT(found.tuvId.w, mesh.triangles.size());
    const ExactHit exact = intersectExactly(mesh, found.tuvId.w, query);
    expectSamePoint(exact, found);
    EXPECT_TRUE(isWithin(exact.t, query, kClose));
    EXPECT_LE(exact.t, nearest * (1.0 + kClose));
}

// Rays that start on voxel faces or run along axes, in voxel faces, or into corners.
std::vector<QueryRay> alignedRays() {
    std::vector<QueryRay> rays;
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f})
            for (const float still : {0.0f, -0.0f, kDenormal, -kDenormal, 1e-30f})
                for (int a = -1; a <= 9; ++a)
                    for (const float b : {-0.25f, 0.0f, 0.3f, 0.5f, 1.0f}) {
                        glm::vec3 direction(still);
                        direction[axis] = sign;
                        glm::vec3 origin(b);
                        origin[(axis + 1) % 3] = float(a) / 8.0f;
                        for (const float start : {-2.0f, 0.0f, 0.125f, 0.4f, 1.0f, 3.0f}) {
                            origin[axis] = start;
                            rays.push_back(rayFrom(origin, direction));
                        }
                    }
    return rays;
}

class RayQuery : public test::OnGpu {
protected:
    void expectAgreement(const Mesh& mesh, const std::vector<QueryRay>& rays, glm::uvec3 dims) {
        for (const std::uint32_t structure :
             {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested}) {
            const Atlas atlas = test::makeAtlas(mesh, structure, dims);
            const auto hits = test::traceQuery(*context, atlas, rays);
            const auto anyHits = test::traceQuery(*context, atlas, rays, {.anyHit = true, .limits = {}});
            ASSERT_EQ(hits.size(), rays.size());
            for (std::size_t i = 0; i < rays.size() && !HasFailure(); ++i) {
                SCOPED_TRACE(testing::Message() << "structure " << structure << ", ray " << i);
                expectNearest(mesh, rays[i], hits[i]);
                EXPECT_EQ(isMiss(anyHits[i]), isMiss(hits[i]));
                if (isMiss(anyHits[i])) continue;
                const ExactHit exact = intersectExactly(mesh, anyHits[i].tuvId.w, rays[i]);
                expectSamePoint(exact, anyHits[i]);
                EXPECT_TRUE(isWithin(exact.t, rays[i], kClose));
            }
        }
    }
};

TEST_F(RayQuery, NoRayLeavesAClosedSphereThroughItsVerticesAndEdges) {
    for (const glm::vec3& centre : {glm::vec3(0.0f), glm::vec3(148376, 1234, -223423)}) {
        const Mesh sphere = test::moved(test::makeSphere(4), 1.0f, centre);
        const auto rays = raysAtVerticesAndEdges(sphere, centre + glm::vec3(0.1f, -0.2f, 0.05f));
        for (const std::uint32_t structure :
             {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested}) {
            const auto hits = test::traceQuery(*context, test::makeAtlas(sphere, structure, {9, 8, 7}), rays);
            EXPECT_EQ(std::count_if(hits.begin(), hits.end(), isMiss), 0) << "structure " << structure;
        }
    }
}

// The plane's normal is then across the ray, as far as floats go.
TEST_F(RayQuery, RaysInATrianglesPlaneHitAtAFiniteDistanceOrNotAtAll) {
    const Mesh mesh = test::makeTriangles({{0, 0, 0}, {0.7f, 0.7f, 0.1f}, {0.3f, 0.3f, 0.9f}});
    std::vector<QueryRay> rays;
    for (int i = 0; i < 1000; ++i) {
        const float z = 0.001f * static_cast<float>(i);
        rays.push_back(rayFrom({-1, -1, z}, {1, 1, 0.37f * (z - 0.5f)}, 0.0f, kInfinity));
        rays.push_back(rayFrom({-1, std::nextafter(-1.0f, 0.0f), z}, {1, 1, 0}, 0.0f, kInfinity));
    }
    const Atlas atlas = test::makeAtlas(mesh, kStructureNested, {3, 3, 3});
    for (const QueryHit& hit : test::traceQuery(*context, atlas, rays))
        EXPECT_TRUE(isMiss(hit) || std::isfinite(distanceOf(hit)));
}

TEST_F(RayQuery, EqualsBruteForceInATriangleSoup) {
    const Mesh mesh = test::makeRandomTriangles(400, 5, 0.15f);
    expectAgreement(mesh, randomRays(mesh, 6000), {13, 9, 16});
}

TEST_F(RayQuery, EqualsBruteForceOnASphereFarFromTheOrigin) {
    const Mesh mesh = test::moved(test::makeSphere(2), 0.5f, {1024.0f, -512.0f, 64.0f});
    expectAgreement(mesh, randomRays(mesh, 6000), {8, 8, 8});
}

TEST_F(RayQuery, EqualsBruteForceInAGridOfOneVoxelAndInAFlatOne) {
    const Mesh mesh = test::makeRandomTriangles(50, 6, 0.3f);
    expectAgreement(mesh, randomRays(mesh, 2000), {1, 1, 1});
    expectAgreement(mesh, randomRays(mesh, 2000), {32, 1, 3});
}

TEST_F(RayQuery, EqualsBruteForceAmongSliversAndGiants) {
    expectAgreement(test::makeSliversAndGiants(200), randomRays(test::makeSliversAndGiants(200), 6000),
                    {7, 5, 6});
}

TEST_F(RayQuery, EqualsBruteForceForASmallDenseSphereInAHugeSquare) {
    // The stadium: thousands of triangles in one voxel of the grid.
    const Mesh mesh = test::joined(test::moved(test::makeSphere(4), 0.002f, {0.31f, 0.52f, 0.001f}),
                                   test::makeTexturedSquare({}));
    std::vector<QueryRay> rays = randomRays(mesh, 1000);
    for (const QueryRay& near : randomRays(test::makeSphere(1), 5000))
        rays.push_back(rayFrom(glm::vec3(near.originTmin) * 0.003f + glm::vec3(0.31f, 0.52f, 0.001f),
                               glm::vec3(near.directionTmax)));
    expectAgreement(mesh, rays, {9, 9, 1});
}

// Needles as narrow as floats have it, and rays that pass the line along one hundreds of its lengths away:
// all that decides on which side of its edges they pass is rounded off.
TEST_F(RayQuery, NeedlesAreNotHitFromFarAlongTheirLine) {
    const glm::vec3 tip(509.90485f, 0.18102f, -213.99765f);
    std::vector<glm::vec3> corners;
    std::vector<QueryRay> rays;
    const std::vector<QueryRay> numbers = randomRays(test::makeSphere(0), 30000);
    for (std::size_t i = 0; i < 30; ++i) {
        const glm::vec3 along = 0.1f * glm::normalize(glm::vec3(numbers[i].directionTmax));
        const glm::vec3 beside(tip.x, std::nextafter(tip.y, 1.0f), tip.z);
        corners.insert(corners.end(), {tip, beside, tip + along});
        for (std::size_t j = i; j < numbers.size(); j += 30) {
            const glm::vec3 direction(numbers[j].directionTmax);
            const float lengths = (j % 2 == 0 ? 0.5f : -0.5f) * static_cast<float>(500 + j % 1000);
            rays.push_back(rayFrom(tip + along * lengths - 0.1f * direction, direction));
        }
    }
    const Mesh needles = test::makeTriangles(corners);
    // Far corners make one voxel of all.
    const Mesh mesh =
        test::joined(needles, test::makeTriangles({tip - 100.0f, tip - 100.0f + glm::vec3(0, 0, 1e-3f),
                                                   tip - 100.0f + glm::vec3(0, 1e-3f, 0), tip + 100.0f,
                                                   tip + 100.0f + glm::vec3(0, 0, 1e-3f),
                                                   tip + 100.0f + glm::vec3(0, 1e-3f, 0)}));
    for (const std::uint32_t structure : {kStructureUniform, kStructureNested})
        for (const QueryHit& hit :
             test::traceQuery(*context, test::makeAtlas(mesh, structure, {1, 1, 1}), rays))
            EXPECT_TRUE(isMiss(hit)) << "triangle " << hit.tuvId.w << " at " << distanceOf(hit);
}

TEST_F(RayQuery, EqualsBruteForceForOneTriangle) {
    const Mesh mesh = test::makeTriangles({{0.1f, 0.2f, 0.3f}, {0.9f, 0.4f, 0.1f}, {0.5f, 0.8f, 0.7f}});
    expectAgreement(mesh, randomRays(mesh, 2000), {3, 3, 3});
}

TEST_F(RayQuery, EqualsBruteForceForAFanOf64TrianglesRoundOneVertex) {
    const Mesh mesh = test::makeFan(64);
    expectAgreement(mesh, randomRays(mesh, 4000), {2, 3, 2});
}

TEST_F(RayQuery, EqualsBruteForceForRaysAlongAxesAndFaces) {
    // The soup's grid is near the unit cube; the rays run at multiples of 1/8, of which some are voxel faces.
    expectAgreement(test::makeRandomTriangles(200, 7, 0.2f), alignedRays(), {8, 8, 8});
}

TEST_F(RayQuery, RaysWithoutADirectionMissAndEnd) {
    const Atlas atlas = test::makeAtlas(test::makeCube(), kStructureCloud, {8, 8, 8});
    std::vector<QueryRay> rays = {rayFrom({0, 0, 0}, {0, 0, 0}), rayFrom({0, 0, 0}, {-0.0f, 0, -0.0f})};
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        rays.push_back(rayFrom({0, 0, 0}, {bad, 1, 1}));
        rays.push_back(rayFrom({0, 0, 0}, {1, 1, bad}));
        rays.push_back(rayFrom({0, bad, 0}, {1, 1, 1}));
    }
    for (const QueryHit& hit : test::traceQuery(*context, atlas, rays)) EXPECT_TRUE(isMiss(hit));
}

TEST_F(RayQuery, LengthOfTheDirectionScalesTOnly) {
    const Atlas atlas = test::makeAtlas(test::makeCube(), kStructureCloud, {8, 8, 8});
    for (const float length : {1e-30f, 1e-10f, 0.3f, 1.0f, 7.0f, 1e10f, 1e30f}) {
        const auto hit = test::traceQuery(*context, atlas,
                                          {rayFrom({0.1f, 0.2f, 0.0f}, {0, 0, length}, 0.0f, kInfinity)})[0];
        EXPECT_FALSE(isMiss(hit)) << length;
        EXPECT_NEAR(distanceOf(hit) * length, 0.5f, 1e-5f) << length;
    }
}

TEST_F(RayQuery, KeepsToTMinAndTMax) {
    const Atlas atlas = test::makeAtlas(test::makeCube(), kStructureCloud, {8, 8, 8});
    const glm::vec3 origin(0.1f, 0.2f, -2.5f); // the cube's faces are at t = 2 and t = 3
    struct Case {
        float tMin, tMax, expected;
    };
    const Case cases[] = {{0, 1e30f, 2},  {1.99f, 9, 2},  {2.01f, 9, 3},      {2.01f, 2.99f, -1},
                          {0, 1.99f, -1}, {3.01f, 9, -1}, {9, 1, -1},         {2, 2, 2},
                          {kNan, 9, -1},  {0, kNan, -1},  {-9, kInfinity, 2}, {0, -1, -1}};
    for (const bool anyHit : {false, true})
        for (const Case& c : cases) {
            const auto hit = test::traceQuery(*context, atlas, {rayFrom(origin, {0, 0, 1}, c.tMin, c.tMax)},
                                              {.anyHit = anyHit, .limits = {}})[0];
            if (!anyHit || c.expected < 0.0f || c.tMin > 2.0f || c.tMax < 3.0f)
                EXPECT_NEAR(distanceOf(hit), c.expected, 1e-5f)
                    << c.tMin << " " << c.tMax << " any " << anyHit;
            else
                EXPECT_FALSE(isMiss(hit));
        }
}

TEST_F(RayQuery, PagesSlabsAndBatchesDoNotChangeAHit) {
    const Mesh mesh = test::makeRandomTriangles(300, 8, 0.1f);
    const Atlas atlas = test::makeAtlas(mesh, kStructureCloud, {10, 12, 40});
    const std::vector<QueryRay> rays = randomRays(mesh, 5000);
    const auto whole = test::traceQuery(*context, atlas, rays);
    ResourceLimits tiny = limits().resources;
    tiny.storageBlockBytes = atlas.references.size() * 4 / 3; // 3 to 6 pages
    tiny.textureSize3D = 12;                                  // slabs of 8
    EXPECT_TRUE(sameBytes(whole, test::traceQuery(*context, atlas, rays, {.limits = tiny})));
    EXPECT_TRUE(sameBytes(whole, test::traceQuery(*context, atlas, rays, {.limits = {}, .maxBatch = 777})));
}

TEST_F(RayQuery, PagesOfBricksDoNotChangeAHit) {
    const Mesh mesh = test::makeRandomTriangles(300, 8, 0.1f);
    const Atlas atlas = test::makeAtlas(mesh, kStructureNested, {3, 4, 5});
    const std::vector<QueryRay> rays = randomRays(mesh, 5000);
    ResourceLimits tiny = limits().resources;
    tiny.storageBlockBytes = atlas.bricks.size_bytes() / 3;
    EXPECT_TRUE(sameBytes(test::traceQuery(*context, atlas, rays),
                          test::traceQuery(*context, atlas, rays, {.limits = tiny})));
}

TEST_F(RayQuery, ScatteredRaysTakeTheSameStepsAndTestsPassAfterPass) {
    const Mesh mesh = test::makeRandomTriangles(300, 8, 0.1f);
    const Atlas atlas = test::makeAtlas(mesh, kStructureNested, {3, 4, 5});
    const std::vector<QueryRay> rays = randomRays(mesh, 5000);
    std::vector<glm::uvec4> counted[2];
    for (const unsigned scattered : {0u, 1u}) {
        SceneFeatures features = queryFeatures(atlas, false);
        features.countWork = 1;
        features.scatteredRays = scattered;
        features.subgroups = scattered && limits().subgroups;
        const ResourcePlan plan =
            planResources(atlas, features, ShaderKind::Query, limits().resources, "atlas");
        const GpuAtlas gpuAtlas = uploadAtlas(atlas, plan, limits(), 0, "atlas");
        GpuRays gpuRays(rays.size(), features, limits());
        const GlProgram program = compileVariant(plan).trace;
        gpuAtlas.bind();
        gpuRays.upload(rays);
        EXPECT_EQ(gpuRays.trace(program, 3, context->device().software).size(), 3u);
        counted[scattered] = gpuRays.readCounters();
    }
    EXPECT_EQ(counted[0], counted[1]);
    EXPECT_GT(std::count_if(counted[0].begin(), counted[0].end(),
                            [](const glm::uvec4& work) { return work.y > 1 && work.z > 1; }),
              1000);
}

TEST_F(RayQuery, NoRaysGiveNoHits) {
    const Atlas atlas = test::makeAtlas(test::makeCube(), kStructureUniform, {2, 2, 2});
    EXPECT_TRUE(test::traceQuery(*context, atlas, {}).empty());
}

} // namespace
} // namespace rt
