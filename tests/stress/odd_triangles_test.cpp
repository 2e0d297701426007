// Triangles that structures and tests have trouble with: slivers, needles, copies, points, and too many at a
// vertex.
#include "tests/stress/closed_mesh.h"
#include "tests/stress/double_referee.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <cmath>

namespace rt {
namespace {

using test::ClosedMesh;
using test::RayNumbers;
using test::RayTargets;

// A triangle `width` wide along each of `count` segments across the unit cube.
Mesh needles(int count, float width, std::uint64_t seed) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        RayNumbers numbers(seed, static_cast<std::uint64_t>(i));
        const glm::vec3 a = numbers.point();
        const glm::vec3 b = numbers.point();
        const float along = numbers.unit();
        corners.insert(corners.end(), {a, b, glm::mix(a, b, along) + numbers.direction() * width});
    }
    return test::makeTriangles(corners);
}

// Needles in the planes between voxels, along the axes; the others of the mesh keep the grid in place.
Mesh needlesOnVoxelFaces(const Mesh& others, const Atlas& atlas) {
    const RayTargets targets(others, atlas.grid);
    std::vector<glm::vec3> corners;
    for (std::uint64_t i = 0; i < 600; ++i) {
        RayNumbers numbers(31, i);
        const auto along = static_cast<int>(numbers.index(3));
        const int aside = (along + 1 + static_cast<int>(numbers.index(2))) % 3;
        glm::vec3 a = targets.voxelCorner(numbers);
        a[along] = targets.anywhere(numbers)[along];
        a = glm::clamp(a, targets.bounds().lo, targets.bounds().hi);
        glm::vec3 b = a, c = a;
        b[along] = targets.anywhere(numbers)[along];
        c[aside] += std::exp2(-8.0f - 16.0f * numbers.unit());
        corners.insert(corners.end(), {a, b, glm::min(c, targets.bounds().hi)});
    }
    return test::joined(others, test::makeTriangles(corners));
}

// A vertex next to an edge of each triangle, as near as floats have one, makes three of it: one is a sliver.
ClosedMesh withSlivers(const ClosedMesh& closed) {
    std::vector<glm::vec3> positions(closed.mesh.positions.begin(), closed.mesh.positions.end());
    std::vector<glm::uvec3> triangles;
    for (std::size_t i = 0; i < closed.mesh.triangles.size(); ++i) {
        const glm::uvec3 t = closed.mesh.triangles[i];
        const auto added = static_cast<std::uint32_t>(positions.size());
        positions.push_back(glm::mix(positions[t.x], positions[t.y], RayNumbers(3, i).between(0.1f, 0.9f)));
        triangles.insert(triangles.end(), {{t.x, t.y, added}, {t.y, t.z, added}, {t.z, t.x, added}});
    }
    return {closed.name + " with slivers at its edges",
            test::makeIndexed(std::move(positions), std::move(triangles)), closed.insides};
}

// Triangles that are a point or a segment, at vertices and edges of the mesh.
Mesh withoutArea(const Mesh& mesh) {
    std::vector<glm::vec3> corners;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y];
        corners.insert(corners.end(), {a, a, a, a, b, a, a, b, b, b, b, a});
    }
    return test::makeTriangles(corners);
}

// The shared vertex above a ring of `count` others.
Mesh umbrella(int count) {
    std::vector<glm::vec3> positions{{0.0f, 0.0f, 0.3f}};
    std::vector<glm::uvec3> triangles;
    const auto vertices = static_cast<std::uint32_t>(count);
    for (std::uint32_t i = 0; i < vertices; ++i) {
        const double angle = 6.283185307179586 * i / count;
        positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
        triangles.emplace_back(0u, 1 + i, 1 + (i + 1) % vertices);
    }
    return test::makeIndexed(std::move(positions), std::move(triangles));
}

class OddTriangles : public test::Stress {
protected:
    static constexpr glm::uvec3 kDims{12, 11, 10};
    static constexpr unsigned kPart = 20;

    // Rays from anywhere at what is hard about the mesh.
    static void expectAsInDouble(const std::string& name, const Mesh& mesh, unsigned part = 1) {
        const Atlas atlas = test::makeAtlas(mesh, kStructureNested, kDims);
        const RayTargets targets(mesh, atlas.grid);
        const test::DoubleReferee referee(mesh, atlas);
        const auto makeRay = [&](RayNumbers& numbers) {
            const glm::vec3 near = targets.anywhere(numbers);
            const glm::vec3 origin = near + targets.diagonal() * numbers.direction();
            return test::rayTowards(origin, targets.any(numbers));
        };
        expectNoneWrong({name, atlas, makeRay, test::asInDouble(referee), "have a wrong hit", true, part});
    }
    static void expectNoLeak(const ClosedMesh& closed, const test::IsWrong& isWrong = test::leaks,
                             const char* fault = "leak") {
        const Atlas atlas = test::makeAtlas(closed.mesh, kStructureNested, kDims);
        const RayTargets targets(closed.mesh, atlas.grid);
        const auto makeRay = [&](RayNumbers& numbers) {
            const glm::vec3 origin = closed.insides[numbers.index(closed.insides.size())];
            return test::rayTowards(origin, targets.any(numbers));
        };
        expectNoneWrong({closed.name, atlas, makeRay, isWrong, fault});
    }
};

TEST_F(OddTriangles, SliversBetweenTrianglesDoNotLeak) {
    expectNoLeak(withSlivers(test::closedSphere()));
    expectNoLeak(withSlivers(test::closedTorus()));
}

TEST_F(OddTriangles, SliversAreHitWhereTheyAreInDouble) {
    for (const float width : {1e-3f, 1e-5f, 1e-8f})
        expectAsInDouble(fmt::format("needles {} wide", width), needles(600, width, 21));
}

TEST_F(OddTriangles, NeedlesOnVoxelFacesAreHitWhereTheyAreInDouble) {
    const Mesh others = test::makeRandomTriangles(50, 9, 0.3f);
    const Atlas atlas = test::makeAtlas(others, kStructureNested, kDims);
    expectAsInDouble("needles on voxel faces", needlesOnVoxelFaces(others, atlas));
}

TEST_F(OddTriangles, OfCopiesTheLowestIndexWins) {
    ClosedMesh copies = test::closedSphere();
    const auto originals = static_cast<std::uint32_t>(copies.mesh.triangles.size());
    copies.mesh = test::joined(test::joined(copies.mesh, copies.mesh), copies.mesh);
    copies.name = "each triangle three times";
    expectNoLeak(
        copies,
        [=](const QueryRay&, const QueryHit& hit, const QueryHitDouble*) { return hit.tuvId.w >= originals; },
        "leak or hit a copy");
}

TEST_F(OddTriangles, TrianglesWithoutAnAreaAreNotThere) {
    ClosedMesh closed = test::closedSphere();
    const Mesh flat = withoutArea(closed.mesh);
    const auto count = static_cast<std::uint32_t>(flat.triangles.size());
    closed.mesh = test::joined(flat, closed.mesh);
    closed.name = "with triangles without an area";
    expectNoLeak(
        closed,
        [=](const QueryRay&, const QueryHit& hit, const QueryHitDouble*) {
            return hit.tuvId.w < count || test::isLost(hit);
        },
        "leak or hit such a triangle");
}

TEST_F(OddTriangles, OneTriangleIsHitWhereItIsInDouble) {
    expectAsInDouble("one triangle",
                     test::makeTriangles({{0.1f, 0.2f, 0.3f}, {0.9f, 0.4f, 0.1f}, {0.5f, 0.8f, 0.7f}}));
}

TEST_F(OddTriangles, FourThousandAtAVertexAreHitWhereTheyAreInDouble) {
    expectAsInDouble("4000 triangles at a vertex", test::makeFan(4000), kPart);
}

TEST_F(OddTriangles, NoRayPassesThroughAnUmbrellaOf4000Triangles) {
    const Mesh mesh = umbrella(4000);
    const Atlas atlas = test::makeAtlas(mesh, kStructureNested, {8, 8, 3});
    const RayTargets targets(mesh, atlas.grid);
    const auto makeRay = [&](RayNumbers& numbers) {
        // At the shared vertex, or somewhere on a spoke.
        const glm::vec3 end = targets.vertex(numbers);
        const glm::vec3 spoke = glm::mix(mesh.positions[0], end, 0.99f * numbers.unit());
        const glm::vec3 aside = numbers.point() - 0.5f;
        const glm::vec3 origin(aside.x, aside.y, numbers.index(2) ? 2.0f : -2.0f);
        return test::rayTowards(origin, numbers.index(2) ? spoke : mesh.positions[0]);
    };
    expectNoneWrong(
        {"umbrella of 4000 triangles", atlas, makeRay, test::leaks, "pass through", false, kPart});
}

} // namespace
} // namespace rt
