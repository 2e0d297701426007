#include "tests/support/make_mesh.h"
#include "tools/rt-grid/place_grid.h"
#include "tools/rt-grid/rebase_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace rt {
namespace {

using test::makeSphere;
using test::moved;

double worldOf(float atlas, const Rebase& rebase, int axis) {
    return double(atlas) / double(rebase.scale) + double(rebase.offsetWorld[axis]);
}

// Sets the last bit of half of the coordinates: a mesh that was moved in floats has zeros there.
Mesh withAllDigits(const Mesh& mesh) {
    std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (std::size_t i = 0; i < positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (positions[i][axis] != 0.0f && (i + static_cast<std::size_t>(axis)) % 2)
                positions[i][axis] =
                    std::bit_cast<float>(std::bit_cast<std::uint32_t>(positions[i][axis]) | 1u);
    Mesh result = mesh;
    result.positions = std::move(positions);
    return result;
}

// How many coordinates of the mesh are not what comes back from atlas space.
int roundedCoordinates(const Mesh& mesh) {
    const Rebase rebase = chooseRebase(boundsOf(mesh));
    const FreshArray<TriangleRecord> records = rebaseTriangles(mesh, rebase);
    int rounded = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const glm::vec4 corners[3] = {records[i].v0, records[i].v1, records[i].v2};
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis)
                rounded += worldOf(corners[corner][axis], rebase, axis) !=
                           double(mesh.positions[mesh.triangles[i][corner]][axis]);
    }
    return rounded;
}

TEST(GridRebase, roundsNoVertexAtAnyScaleAndOffset) {
    const Mesh sphere = makeSphere(3);
    std::vector<float> sizes;
    for (int exponent = -12; exponent <= 12; exponent += 3) {
        sizes.push_back(std::pow(10.0f, static_cast<float>(exponent)));
        sizes.push_back(
            std::ldexp(1.2f, 3 * exponent)); // the far side of the sphere in another binade than its radius
    }
    for (const float size : sizes)
        for (const float distance : {0.0f, 0.7f, 1.1f, 1.7f, 2.3f, 3.0f, 3.1f, 100.0f, 148376.0f, 1e7f})
            for (const glm::vec3 direction :
                 {glm::vec3(1, 1, 1), glm::vec3(1, -0.003f, 0), glm::vec3(-1, 0.4f, 1e-3f)})
                EXPECT_EQ(roundedCoordinates(withAllDigits(moved(sphere, size, direction * distance * size))),
                          0)
                    << "size " << size << ", distance " << distance;
}

TEST(GridRebase, makesTheLargestExtentHalfToOneByAPowerOfTwo) {
    for (const float size : {1e-12f, 3e-4f, 0.5f, 1.0f, 3.0f, 1024.0f, 1e12f}) {
        const Mesh mesh = test::moved(test::makeBox(glm::vec3(-1, 0, 0), glm::vec3(1, 0.3f, 0.1f)), size,
                                      glm::vec3(7 * size));
        const Rebase rebase = chooseRebase(boundsOf(mesh));
        int exponent = 0;
        EXPECT_EQ(std::frexp(rebase.scale, &exponent), 0.5f);
        const BoundsD bounds = gridBounds(rebaseTriangles(mesh, rebase));
        EXPECT_GE(bounds.extent().x, 0.5);
        EXPECT_LE(bounds.extent().x, 1.0);
    }
}

TEST(GridRebase, keepsCoordinatesNearTheExtentsSize) {
    const Mesh mesh = test::moved(test::makeCube(), 1.0f, glm::vec3(1e6f, -3.0f, 0.25f));
    for (const TriangleRecord& t : rebaseTriangles(mesh, chooseRebase(boundsOf(mesh))))
        for (const glm::vec4& v : {t.v0, t.v1, t.v2})
            for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(v[axis]), 2.0f);
}

TEST(GridRebase, clampsTheScaleOfExtremeScenes) {
    Bounds tiny;
    tiny.add(glm::vec3(0.0f));
    tiny.add(glm::vec3(1e-44f));
    EXPECT_EQ(chooseRebase(tiny).scale, 0x1p120f);
    Bounds huge;
    huge.add(glm::vec3(-3e38f));
    huge.add(glm::vec3(3e38f));
    EXPECT_EQ(chooseRebase(huge).scale, 0x1p-120f);
    Bounds point;
    point.add(glm::vec3(5.0f));
    EXPECT_EQ(chooseRebase(point).scale, 1.0f);
    EXPECT_EQ(chooseRebase(point).offsetWorld, glm::vec3(5.0f));
}

TEST(GridRebase, recordsCarryTheTrianglesIndex) {
    const auto records = rebaseTriangles(makeSphere(1), Rebase{});
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(records[i].v0.w), i);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(records[i].v1.w), 0u);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(records[i].v2.w), 0u);
    }
}

// Whether the one triangle of these corners, in atlas space, is marked.
bool isMarked(const std::vector<glm::vec3>& corners) {
    const auto records = rebaseTriangles(test::makeTriangles(corners), Rebase{});
    const float mark = records[0].v1.w;
    EXPECT_TRUE(mark == 0.0f || mark == 1.0f) << mark;
    return mark != 0.0f;
}

// A base of length s and a height h over its middle: edges of size s and s / 2 + h, and area s h, so that the
// limit is h = 2^-15 s (s / 2 + h), next to 2^-16 s^2.
TEST(GridRebase, aTriangleIsASliverBelowAHeightThatGrowsWithItsLengthsSquare) {
    for (const float s : {2.0f, 1.0f, 0.5f, 0x1p-8f}) {
        const auto isMarkedAt = [&](float height) {
            return isMarked({{0, 0, 0}, {s, 0, 0}, {0.5f * s, height, 0}});
        };
        const float limit = 0x1p-16f * s * s;
        EXPECT_TRUE(isMarkedAt(limit)) << "size " << s;
        EXPECT_FALSE(isMarkedAt(limit * (1.0f + 0x1p-12f))) << "size " << s;
        EXPECT_TRUE(isMarkedAt(0x1p-20f * limit)) << "size " << s;
        EXPECT_FALSE(isMarkedAt(s)) << "size " << s;
    }
}

TEST(GridRebase, aSliverIsMarkedWhicheverCornerIsFirst) {
    std::vector<glm::vec3> sliver{{0, 0, 0}, {1, 0, 0}, {0.5f, 0x1p-18f, 0}};
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(isMarked(sliver)) << i;
        std::rotate(sliver.begin(), sliver.begin() + 1, sliver.end());
    }
}

// No ray hits those: the test with care would be for nothing.
TEST(GridRebase, aTriangleWithoutAnAreaIsNoSliver) {
    const glm::vec3 a(0.25f, 0.5f, 0.75f), b(0.5f, 0.75f, 1.0f);
    EXPECT_FALSE(isMarked({a, a, a}));
    EXPECT_FALSE(isMarked({a, b, b}));
    EXPECT_FALSE(isMarked({a, b, 0.5f * (a + b)}));
    EXPECT_FALSE(isMarked({a, b, a}));
}

TEST(GridPlace, everyTriangleLiesWellInsideTheGridForAllResolutions) {
    for (const unsigned side : {1u, 2u, 7u, 256u, 1024u, 65536u})
        for (const float offset : {0.0f, 0.3f, -1.7f, 1e5f}) {
            const Mesh mesh = test::moved(makeSphere(2), 0.37f, glm::vec3(offset, 0.1f, -offset));
            const BoundsD bounds = gridBounds(rebaseTriangles(mesh, chooseRebase(boundsOf(mesh))));
            const GridLayout grid = placeGrid(bounds, glm::uvec3(side, 1u, side));
            for (int axis = 0; axis < 3; ++axis) {
                const double cell = grid.cellSize[axis];
                const double wanted = std::max(1.0 / 64, 12.0 * 0x1p-24 * side);
                EXPECT_GE((bounds.lo[axis] - grid.gridLo[axis]) / cell, wanted);
                EXPECT_GE((grid.gridLo[axis] + grid.dims[axis] * cell - bounds.hi[axis]) / cell, wanted);
            }
        }
}

TEST(GridPlace, flatAndPointLikeScenesGetAVolume) {
    const Mesh flat = test::makeTexturedSquare({});
    const BoundsD bounds = gridBounds(rebaseTriangles(flat, chooseRebase(boundsOf(flat))));
    EXPECT_NEAR(bounds.extent().z, 1e-3 * bounds.extent().x, 1e-9);
    const Mesh point = test::makeTriangles(std::vector<glm::vec3>(3, glm::vec3(4.0f, 5.0f, 6.0f)));
    const BoundsD box = gridBounds(rebaseTriangles(point, chooseRebase(boundsOf(point))));
    for (int axis = 0; axis < 3; ++axis) EXPECT_GT(box.extent()[axis], 0.0);
}

TEST(GridPlace, padsMoreWhereFloatsAreCoarserThanVoxels) {
    const BoundsD bounds{glm::dvec3(0.0), glm::dvec3(1.0)};
    EXPECT_EQ(placeGrid(bounds, glm::uvec3(256)).padCells, 0x1p-8);
    EXPECT_EQ(placeGrid(bounds, glm::uvec3(4096, 1, 1)).padCells, 0x1p-8);
    EXPECT_EQ(placeGrid(bounds, glm::uvec3(1, 1, 65536)).padCells, 0x1p-4);
}

} // namespace
} // namespace rt
