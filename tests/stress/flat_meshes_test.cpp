// Sheets of triangles on the faces of voxels, across them, and one upon the other. No ray may pass through
// one.
#include "tests/stress/double_referee.h"
#include "tests/stress/flat_scene.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <cmath>

namespace rt {
namespace {

using test::FlatScene;
using test::MovePoint;
using test::RayNumbers;
using test::RayTargets;

struct Orientation {
    const char* name;
    MovePoint move;
    glm::vec3 normal;
};

glm::vec3 tilted(const glm::vec3& p) {
    return {p.x, p.y, 0.6f * p.z + 0.3f * p.x - 0.2f * p.y};
}
const Orientation kAcrossZ{"across z", [](const glm::vec3& p) { return p; }, {0, 0, 1}};
const Orientation kOrientations[] = {
    kAcrossZ,
    {"across x", [](const glm::vec3& p) { return glm::vec3(p.z, p.x, p.y); }, {1, 0, 0}},
    {"across y", [](const glm::vec3& p) { return glm::vec3(p.y, p.z, p.x); }, {0, 1, 0}},
    {"tilted", tilted, glm::normalize(glm::vec3(-0.3f, 0.2f, 1.0f))},
};

// Rows of `sheet` at y = -1, -0.9, 0.9 and 1: those between are long.
glm::vec3 toLongRow(const glm::vec3& p) {
    return {p.x, std::abs(p.y) < 0.99f ? std::copysign(0.9f, p.y) : p.y, p.z};
}

// The strips of `sheet` between its first and last one become 1e-8 wide, which floats can tell near 0 only.
glm::vec3 toSeam(const glm::vec3& p, int strips) {
    const float strip = std::round(0.5f * p.x * static_cast<float>(strips));
    return toLongRow({std::abs(p.x) < 0.9999f ? 1e-8f * strip : p.x, p.y, p.z});
}

class FlatMeshes : public test::Stress {
protected:
    static constexpr unsigned kLayers = 12;
    static constexpr unsigned kPart = 10;

    static void expectTight(const std::string& name, const Mesh& sheet, const std::vector<float>& heights,
                            float reach, const Orientation& orientation, unsigned part = 1) {
        const FlatScene scene = test::stack(sheet, heights, reach, orientation.move, orientation.normal);
        const Atlas atlas = test::makeAtlas(scene.mesh, kStructureNested, glm::uvec3(kLayers));
        const RayTargets inner(scene.inner, atlas.grid);
        expectNoneWrong({fmt::format("{}, {}", name, orientation.name), atlas,
                         [&](RayNumbers& numbers) { return rayAtSheet(scene, inner, numbers); },
                         test::passesThrough, "pass through", false, part});
    }
};

TEST_F(FlatMeshes, NoRayPassesThroughAPlaneOnVoxelFaces) {
    for (const Orientation& orientation : kOrientations)
        expectTight("planes on voxel faces", test::makeSheet(37, 41), test::voxelFaces(kLayers), 0.9f,
                    orientation);
}

TEST_F(FlatMeshes, NoRayPassesThroughAPlaneOfFewTriangles) {
    for (const Orientation& orientation : kOrientations)
        expectTight("plane of 4x4 squares", test::makeSheet(4, 4), {0.1f}, 0.6f, orientation);
}

TEST_F(FlatMeshes, NoRayPassesThroughNeedlesAlongVoxelFaces) {
    const Mesh needles = test::mapped(test::makeSheet(4000, 3), toLongRow);
    for (const Orientation& orientation : kOrientations)
        expectTight("needles of aspect 3600 along voxel faces", needles, {test::voxelFaces(kLayers)[1]},
                    0.95f, orientation, kPart);
}

TEST_F(FlatMeshes, NoRayPassesThroughSliversOfAspect1e8) {
    constexpr int kStrips = 202; // all in one voxel
    const Mesh seam =
        test::mapped(test::makeSheet(kStrips, 3), [](const glm::vec3& p) { return toSeam(p, kStrips); });
    for (const Orientation& orientation : kOrientations)
        expectTight("slivers of aspect 1.8e8", seam, {test::voxelFaces(kLayers)[1]}, 0.95f, orientation,
                    kPart);
}

// Layers that lie `ulps` floats apart; rays from both sides.
class Stacks : public FlatMeshes {
protected:
    static constexpr int kCount = 16;
    static constexpr double kFourRoundings = 0x1p-22 * 1.25; // of the largest coordinate
    static constexpr std::uint32_t kPerLayer = 2 * 8 * 8;

    static FlatScene layers(int ulps, const Orientation& orientation) {
        std::vector<float> heights{0.7f};
        for (int i = 1; i < kCount; ++i) {
            float next = heights.back();
            for (int j = 0; j < ulps; ++j) next = std::nextafter(next, 1.0f);
            heights.push_back(next);
        }
        FlatScene scene =
            test::stack(test::makeSheet(8, 8), heights, 0.8f, orientation.move, orientation.normal);
        scene.gap = 0.5f; // rays come from outside
        return scene;
    }
    static bool isSameLayer(const QueryHit& hit, const QueryHitDouble& reference) {
        return hit.tuvId.w / kPerLayer == reference.triangle / kPerLayer;
    }
};

// Where the layers lie across an axis, the height over them has four roundings at most; layers so close may
// be one distance, and then the lowest index wins.
TEST_F(Stacks, LayersOneUlpApartAreHitAtTheNearestDistance) {
    for (const Orientation& orientation : kOrientations) {
        const FlatScene scene = layers(1, orientation);
        const Atlas atlas = test::makeAtlas(scene.mesh, kStructureNested, glm::uvec3(kLayers));
        const RayTargets inner(scene.inner, atlas.grid);
        const test::DoubleReferee referee(scene.mesh, atlas);
        const auto makeRay = [&](RayNumbers& numbers) { return rayAtSheet(scene, inner, numbers); };
        const std::string name = fmt::format("layers 1 ulp apart, {}", orientation.name);
        const bool isAligned = orientation.normal.x * orientation.normal.y == 0.0f; // not tilted
        expectNoneWrong({name, atlas, makeRay,
                         [&](const QueryRay& ray, const QueryHit& hit, const QueryHitDouble* reference) {
                             const double apart = std::abs(test::distanceOf(hit) - reference->t);
                             const double steepness =
                                 std::abs(glm::dot(orientation.normal, glm::vec3(ray.directionTmax)));
                             return test::isLost(hit) || referee.isWrong(ray, hit, *reference) ||
                                    (isAligned && apart * steepness > kFourRoundings);
                         },
                         "are wrong by more than rounding", true, kPart});
        const test::StressCase other{
            name,
            atlas,
            makeRay,
            [](const QueryRay&, const QueryHit& hit, const QueryHitDouble* reference) {
                return !isSameLayer(hit, *reference);
            },
            "take another layer than in double precision",
            true,
            kPart};
        report(other, "watertight", measured(other, kIntersectWatertight));
    }
}

TEST_F(Stacks, TheNearestOfLayers64UlpsApartWins) {
    for (const Orientation& orientation : kOrientations) {
        const FlatScene scene = layers(64, orientation);
        const Atlas atlas = test::makeAtlas(scene.mesh, kStructureNested, glm::uvec3(kLayers));
        const RayTargets inner(scene.inner, atlas.grid);
        expectNoneWrong({fmt::format("layers 64 ulps apart, {}", orientation.name), atlas,
                         [&](RayNumbers& numbers) { return rayAtSheet(scene, inner, numbers); },
                         [](const QueryRay&, const QueryHit& hit, const QueryHitDouble* reference) {
                             return test::isLost(hit) || !isSameLayer(hit, *reference);
                         },
                         "take another layer than in double precision", true, kPart});
    }
}

} // namespace
} // namespace rt
