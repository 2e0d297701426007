// Rays from inside closed meshes: each has to hit something, at any scale and any distance from the origin.
#include "tests/stress/closed_mesh.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>

#include <filesystem>

namespace rt {
namespace {

using test::ClosedMesh;
using test::kPlacements;
using test::kSphereOnly;
using test::Placement;
using test::RayNumbers;
using test::RayTargets;
using test::StressCase;
using test::Tally;

constexpr unsigned kTimes = 6; // so that all cases together have 10 million rays by default

/// From an inside point at a vertex, at an edge, at a corner of a voxel, or anywhere.
QueryRay rayInside(const ClosedMesh& closed, const RayTargets& targets, RayNumbers& numbers) {
    const glm::vec3 origin = closed.insides[numbers.index(closed.insides.size())];
    switch (numbers.index(4)) {
    case 0:
        return test::rayTowards(origin, targets.vertex(numbers));
    case 1:
        return test::rayTowards(origin, targets.onEdge(numbers));
    case 2:
        return test::rayTowards(origin, targets.voxelCorner(numbers));
    default:
        return test::rayFrom(origin, numbers.direction());
    }
}

class ClosedMeshes : public test::Stress {
protected:
    static void TearDownTestSuite() {
        fmt::print("closed meshes in all, watertight: {} of {} rays leak, each traced by both kernels\n",
                   total_.wrong, total_.rays);
        Stress::TearDownTestSuite();
    }

    static void expectNoLeak(const ClosedMesh& closed) {
        for (const std::uint32_t structure : {kStructureCloud, kStructureNested}) {
            const Atlas atlas = test::makeAtlas(closed.mesh, structure, {12, 11, 10});
            const RayTargets targets(closed.mesh, atlas.grid);
            StressCase stress{closed.name + (structure == kStructureCloud ? ", cloud" : ", nested"), atlas,
                              [&](RayNumbers& numbers) { return rayInside(closed, targets, numbers); }};
            stress.times = kTimes;
            const Tally tally = watertight(stress);
            report(stress, "watertight", tally);
            EXPECT_EQ(tally.wrong, 0u) << stress.name << ": " << tally.firstWrong;
            total_.rays += tally.rays;
            total_.wrong += tally.wrong;
        }
    }

    // The rates of the others are measured, not judged; but that they leak shows that these rays can find
    // leaks.
    static void expectLeaksOfOtherTests(const ClosedMesh& closed) {
        const Atlas atlas = test::makeAtlas(closed.mesh, kStructureNested, {12, 11, 10});
        const RayTargets targets(closed.mesh, atlas.grid);
        const StressCase stress{closed.name + ", nested", atlas,
                                [&](RayNumbers& numbers) { return rayInside(closed, targets, numbers); }};
        for (const auto& [name, intersect] : {std::pair("moller-trumbore", kIntersectMollerTrumbore),
                                              std::pair("baldwin-weber", kIntersectBaldwinWeber)}) {
            const Tally tally = measured(stress, intersect);
            report(stress, name, tally);
            EXPECT_GT(tally.wrong, 0u) << name;
        }
    }

private:
    static inline Tally total_;
};

TEST_F(ClosedMeshes, TheWatertightTestLosesNoRayInASphere) {
    for (const Placement& placement : kPlacements) expectNoLeak(placement.of(test::closedSphere()));
    expectNoLeak(kSphereOnly.of(test::closedSphere()));
}

TEST_F(ClosedMeshes, TheWatertightTestLosesNoRayInATorus) {
    for (const Placement& placement : kPlacements) expectNoLeak(placement.of(test::closedTorus()));
}

TEST_F(ClosedMeshes, NoTestLosesRaysInTheBunnyButTheOthers) {
    const std::string path = test::scenePath("models/statues/bun_zipper.ply");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const ClosedMesh bunny = test::closedModel("bunny", path);
    ASSERT_TRUE(test::isClosed(bunny.mesh));
    ASSERT_FALSE(bunny.insides.empty());
    for (const glm::vec3& inside : bunny.insides)
        ASSERT_NEAR(test::windingNumber(bunny.mesh, inside), 1.0, 1e-6);
    expectNoLeak(kPlacements[0].of(bunny));
    expectLeaksOfOtherTests(kPlacements[0].of(bunny));
}

TEST_F(ClosedMeshes, TheOtherTestsLoseRays) {
    for (const ClosedMesh& closed : {test::closedSphere(), test::closedTorus()})
        expectLeaksOfOtherTests(kPlacements[0].of(closed));
}

} // namespace
} // namespace rt
