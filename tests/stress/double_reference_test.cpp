// Hits of random rays against the same in double precision: none on another triangle that is not a tie.
#include "tests/gpu/exact_hit.h"
#include "tests/stress/closed_mesh.h"
#include "tests/stress/double_referee.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

namespace rt {
namespace {

using test::RayNumbers;
using test::RayTargets;

// Half of the rays from the bounds, half from outside; a few may not go far.
QueryRay randomRay(const RayTargets& targets, RayNumbers& numbers) {
    const glm::vec3 target = targets.anywhere(numbers);
    const glm::vec3 direction = numbers.direction();
    const float size = targets.diagonal();
    const glm::vec3 origin = numbers.index(2) ? target : target - 3.0f * size * direction;
    const float tMin = numbers.index(8) ? 0.0f : 0.3f * size * numbers.unit();
    return test::rayFrom(origin, direction, tMin,
                         numbers.index(8) ? test::kNoEnd : tMin + size * numbers.unit());
}

// The reference walks the same atlas: what that does not list where it is, both would miss.
bool isBruteForce(const Mesh& mesh, const QueryRay& ray, const QueryHitDouble& hit) {
    constexpr double kRounding = 1e-9; // far more than that of doubles
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const test::ExactHit exact = test::intersectExactly(mesh, i, ray);
        const bool isWanted = exact.t >= ray.originTmin.w * (1.0 + kRounding) &&
                              exact.t <= ray.directionTmax.w * (1.0 - kRounding);
        if (exact.margin > kRounding && isWanted) nearest = std::min(nearest, exact.t);
    }
    if (hit.triangle == kNoTriangle) return std::isinf(nearest);
    const test::ExactHit exact = test::intersectExactly(mesh, hit.triangle, ray);
    const bool isWhereItIs = exact.margin > -kRounding && std::abs(hit.t - exact.t) <= kRounding * exact.t;
    const bool isWithinLimits = hit.t >= ray.originTmin.w && hit.t <= ray.directionTmax.w;
    return isWhereItIs && isWithinLimits && hit.t <= nearest * (1.0 + kRounding);
}

class DoubleReference : public test::Stress {
protected:
    static constexpr std::size_t kBruteForce = 400;

    static void expectBruteForce(const std::string& name, const Mesh& mesh, const Atlas& atlas) {
        const RayTargets targets(mesh, atlas.grid);
        std::vector<QueryRay> rays;
        for (std::size_t i = 0; i < kBruteForce; ++i) {
            RayNumbers numbers(17, i);
            rays.push_back(randomRay(targets, numbers));
        }
        const auto hits = test::traceDouble(*context, atlas, rays);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) wrong += !isBruteForce(mesh, rays[i], hits[i]);
        fmt::print("{}, double precision: {} of {} rays have another hit than brute force\n", name, wrong,
                   rays.size());
        EXPECT_EQ(wrong, 0u) << name;
    }
    static void expectNoneWrongIn(const std::string& name, const Mesh& mesh) {
        for (const std::uint32_t structure : {kStructureCloud, kStructureNested}) {
            const std::string nameHere = name + (structure == kStructureCloud ? ", cloud" : ", nested");
            const Atlas atlas = test::makeAtlas(mesh, structure, {32, 31, 30});
            const RayTargets targets(mesh, atlas.grid);
            const test::DoubleReferee referee(mesh, atlas);
            expectBruteForce(nameHere, mesh, atlas);
            expectNoneWrong({nameHere, atlas,
                             [&](RayNumbers& numbers) { return randomRay(targets, numbers); },
                             test::asInDouble(referee), "have a wrong triangle", true});
        }
    }
};

TEST_F(DoubleReference, NoHitOfASphereIsWrong) {
    expectNoneWrongIn("random rays, sphere", test::makeSphere(4));
}

TEST_F(DoubleReference, NoHitOfRandomTrianglesIsWrong) {
    expectNoneWrongIn("random rays, 20000 random triangles", test::makeRandomTriangles(20'000, 12, 0.05f));
}

TEST_F(DoubleReference, NoHitOfTheBunnyIsWrong) {
    const std::string path = test::scenePath("models/statues/bun_zipper.ply");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    expectNoneWrongIn("random rays, bunny", test::closedModel("bunny", path).mesh);
}

} // namespace
} // namespace rt
