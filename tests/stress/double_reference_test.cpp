// Hits of random rays against the same in double precision: none on another triangle that is not a tie.
#include "tests/stress/closed_mesh.h"
#include "tests/stress/double_referee.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"
#include "tests/support/scenes.h"

#include <filesystem>

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

class DoubleReference : public test::Stress {
protected:
    static void expectNoneWrongIn(const std::string& name, const Mesh& mesh) {
        for (const std::uint32_t structure : {kStructureCloud, kStructureNested}) {
            const Atlas atlas = test::makeAtlas(mesh, structure, {32, 31, 30});
            const RayTargets targets(mesh, atlas.grid);
            const test::DoubleReferee referee(mesh, atlas.grid);
            expectNoneWrong({name + (structure == kStructureCloud ? ", cloud" : ", nested"), atlas,
                             [&](RayNumbers& numbers) { return randomRay(targets, numbers); },
                             [&](const QueryRay& ray, const QueryHit& hit, const QueryHitDouble* reference) {
                                 return referee.isWrong(ray, hit, *reference);
                             },
                             "have a wrong triangle", true});
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
