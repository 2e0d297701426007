// What a traversal of nested voxels relies on, judged from the atlas' arrays alone.
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rt {
namespace {

struct Case {
    const char* name;
    Mesh mesh;
    glm::uvec3 dims;
};

std::vector<Case> cases() {
    const Mesh stadium = test::joined(test::moved(test::makeSphere(3), 0.002f, {0.31f, 0.52f, 0.001f}),
                                      test::makeTexturedSquare({}));
    return {{"sphere", test::makeSphere(2), {2, 2, 3}},
            {"far sphere", test::moved(test::makeSphere(2), 1.0f, {148376, 1234, -223423}), {4, 4, 4}},
            {"small triangles", test::makeRandomTriangles(500, 1, 0.05f), {4, 4, 3}},
            {"large triangles", test::makeRandomTriangles(60, 2, 0.5f), {2, 2, 3}},
            {"slivers and giants", test::makeSliversAndGiants(60), {2, 2, 2}},
            {"a dense sphere in a huge square", stadium, {9, 9, 1}},
            {"one triangle", test::makeRandomTriangles(1, 3, 0.5f), {1, 1, 1}},
            {"64 triangles round a vertex", test::makeFan(64), {2, 2, 2}}};
}

Atlas build(const Mesh& mesh, const glm::uvec3& dims, const NestOptions& nest = {}) {
    BuildOptions options;
    options.nest = nest;
    options.structure = kStructureNested;
    options.resolution.exact = dims;
    StageTimer timer;
    Atlas atlas = buildAtlas(MeshFile{mesh, 0}, "mesh", options, timer).atlas;
    validate(atlas, "atlas");
    return atlas;
}

struct Cell {
    glm::ivec3 at;
    int level;
    std::uint32_t word;
};

// Empty voxels and leaves of all levels.
std::vector<Cell> cellsOf(const Atlas& atlas) {
    std::vector<Cell> cells;
    const auto add = [&](std::size_t i, const glm::uvec3& dims, const glm::ivec3& first, int level,
                         std::uint32_t word) {
        const std::size_t row = i / dims.x;
        if (!isBrick(word))
            cells.push_back(
                {first + glm::ivec3(glm::uvec3(i % dims.x, row % dims.y, row / dims.y)), level, word});
    };
    for (std::size_t i = 0; i < atlas.voxels.size(); ++i)
        add(i, atlas.grid.dims, glm::ivec3(0), 0, atlas.voxels[i]);
    for (const BrickPlace& brick : bricksOf(atlas, "atlas"))
        for (std::uint32_t i = 0; i < brick.words(); ++i)
            add(i, glm::uvec3(1u << brick.shift), brick.first, brick.level, atlas.bricks[brick.offset + i]);
    return cells;
}

using Polygon = std::vector<glm::dvec3>;

Polygon clipped(const Polygon& polygon, int axis, double bound, double side) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3& a = polygon[i];
        const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
        const double ha = side * (a[axis] - bound);
        const double hb = side * (b[axis] - bound);
        if (ha >= 0) kept.push_back(a);
        if ((ha < 0) != (hb < 0)) kept.push_back(a + (b - a) * (ha / (ha - hb)));
    }
    return kept;
}

// The triangles of an atlas in voxels of the grid.
class Triangles {
public:
    explicit Triangles(const Atlas& atlas) {
        const glm::dvec3 lo(atlas.grid.gridLo);
        const glm::dvec3 size(atlas.grid.cellSize);
        for (const TriangleRecord& t : atlas.triangles)
            polygons_.push_back({(glm::dvec3(t.v0) - lo) / size, (glm::dvec3(t.v1) - lo) / size,
                                 (glm::dvec3(t.v2) - lo) / size});
    }
    const Polygon& operator[](std::size_t i) const { return polygons_[i]; }
    std::size_t size() const { return polygons_.size(); }

    // Whether the triangle meets a box (Sutherland & Hodgman 1974).
    bool meets(std::size_t i, const glm::dvec3& lo, const glm::dvec3& hi) const {
        Polygon polygon = polygons_[i];
        for (int axis = 0; axis < 3; ++axis) {
            const auto [least, most] =
                std::minmax({polygons_[i][0][axis], polygons_[i][1][axis], polygons_[i][2][axis]});
            if (least > hi[axis] || most < lo[axis]) return false;
        }
        for (int axis = 0; axis < 3 && !polygon.empty(); ++axis)
            polygon = clipped(clipped(polygon, axis, lo[axis], 1.0), axis, hi[axis], -1.0);
        return !polygon.empty();
    }

private:
    std::vector<Polygon> polygons_;
};

std::vector<std::uint32_t> listOf(const Atlas& atlas, std::uint32_t word) {
    std::vector<std::uint32_t> ids;
    copyTriangles(atlas.references, leafList(word), ids);
    return ids;
}

TEST(GridNested, leavesListTheTrianglesThatTheyMeetAndEmptyBoxesMeetNone) {
    for (const auto& [name, mesh, dims] : cases()) {
        const Atlas atlas = build(mesh, dims);
        const Triangles triangles(atlas);
        std::size_t notListed = 0, leaptOver = 0, leaves = 0, empties = 0;
        for (const Cell& cell : cellsOf(atlas)) {
            const bool leaf = cell.word & kOccupiedBit;
            const double scale = std::ldexp(1.0, -cell.level);
            const glm::ivec3 below = leaf ? glm::ivec3(0) : freeBelow(cell.word);
            const glm::ivec3 above = leaf ? glm::ivec3(0) : freeAbove(cell.word);
            const glm::dvec3 lo = glm::dvec3(cell.at - below) * scale;
            const glm::dvec3 hi = glm::dvec3(cell.at + above + 1) * scale;
            const std::vector<std::uint32_t> ids =
                leaf ? listOf(atlas, cell.word) : std::vector<std::uint32_t>();
            ++(leaf ? leaves : empties);
            EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()), ids.end());
            for (std::uint32_t i = 0; i < triangles.size(); ++i) {
                if (!triangles.meets(i, lo, hi)) continue;
                if (!leaf) ++leaptOver;
                if (leaf) notListed += !std::binary_search(ids.begin(), ids.end(), i);
            }
        }
        EXPECT_EQ(notListed, 0u) << name;
        EXPECT_EQ(leaptOver, 0u) << name;
        EXPECT_EQ(leaves, atlas.info.occupiedVoxels) << name;
        EXPECT_TRUE(empties > 0u || leaves == 1u) << name;
    }
}

std::uint32_t exitBoxOf(const Atlas& atlas, std::uint32_t leaf) {
    return atlas.references[leafList(leaf)];
}

// How many triangles meet the exit boxes of leaves that do not list them; `wider` voxels are added on all
// sides.
std::size_t missedByExits(const Atlas& atlas, int wider) {
    const Triangles triangles(atlas);
    std::size_t missed = 0;
    for (const Cell& cell : cellsOf(atlas)) {
        if (!(cell.word & kOccupiedBit)) continue;
        const std::uint32_t box = exitBoxOf(atlas, cell.word);
        const double scale = std::ldexp(1.0, -cell.level);
        const glm::dvec3 lo = glm::dvec3(cell.at - freeBelow(box) - wider) * scale;
        const glm::dvec3 hi = glm::dvec3(cell.at + freeAbove(box) + 1 + wider) * scale;
        const std::vector<std::uint32_t> ids = listOf(atlas, cell.word);
        for (std::uint32_t i = 0; i < triangles.size(); ++i)
            missed += triangles.meets(i, lo, hi) && !std::binary_search(ids.begin(), ids.end(), i);
    }
    return missed;
}

int exitExtents(const Atlas& atlas) {
    int sum = 0;
    for (const Cell& cell : cellsOf(atlas)) {
        if (!(cell.word & kOccupiedBit)) continue;
        const glm::ivec3 extents =
            freeBelow(exitBoxOf(atlas, cell.word)) + freeAbove(exitBoxOf(atlas, cell.word));
        sum += extents.x + extents.y + extents.z;
    }
    return sum;
}

TEST(GridNested, aLeafListsAllTrianglesThatMeetItsExitBox) {
    NestOptions far;
    far.exitReach = 31;
    for (const auto& [name, mesh, dims] : cases()) {
        EXPECT_EQ(missedByExits(build(mesh, dims), 0), 0u) << name;
        EXPECT_EQ(missedByExits(build(mesh, dims, far), 0), 0u) << name;
    }
    for (unsigned seed = 10; seed < 20; ++seed) {
        const Mesh mesh = test::makeRandomTriangles(120, seed, 0.02f * static_cast<float>(seed - 8));
        EXPECT_EQ(missedByExits(build(mesh, {3, 4, 2}), 0), 0u) << seed;
    }
}

TEST(GridNested, exitBoxesOneVoxelWiderWouldMissTriangles) {
    EXPECT_GT(missedByExits(build(test::makeSphere(2), {2, 2, 3}), 1), 0u);
}

TEST(GridNested, exitBoxesReachAsFarAsTheyMay) {
    const auto extentsAt = [](int reach) {
        NestOptions options;
        options.exitReach = reach;
        return exitExtents(build(test::makeSphere(3), {3, 3, 3}, options));
    };
    const auto leaves = static_cast<int>(build(test::makeSphere(3), {3, 3, 3}).info.occupiedVoxels);
    EXPECT_EQ(extentsAt(0), 0);
    EXPECT_GT(extentsAt(1), leaves);
    EXPECT_GT(extentsAt(3), extentsAt(1));
    // One leaf: the whole world is free behind it.
    EXPECT_EQ(exitExtents(build(test::makeRandomTriangles(1, 3, 0.5f), {1, 1, 1})),
              6 * NestOptions().exitReach);
}

// How many triangles meet the boxes of empty voxels.
std::size_t leaptOver(const Atlas& atlas) {
    const Triangles triangles(atlas);
    std::size_t met = 0;
    for (const Cell& cell : cellsOf(atlas)) {
        if (cell.word & kOccupiedBit) continue;
        const double scale = std::ldexp(1.0, -cell.level);
        const glm::dvec3 lo = glm::dvec3(cell.at - freeBelow(cell.word)) * scale;
        const glm::dvec3 hi = glm::dvec3(cell.at + freeAbove(cell.word) + 1) * scale;
        for (std::uint32_t i = 0; i < triangles.size(); ++i) met += triangles.meets(i, lo, hi);
    }
    return met;
}

// The grid is grown in tiles of 8^3 voxels.
TEST(GridNested, boxesAreSoundAcrossTilesAndWithoutBricks) {
    const Mesh mesh = test::makeRandomTriangles(500, 4, 0.1f);
    for (const int depth : {0, 3})
        for (const int reach : {0, 3, 31}) {
            NestOptions options;
            options.maxDepth = depth; // 0: octant
            options.exitReach = reach;
            const Atlas atlas = build(mesh, {19, 17, 18}, options);
            EXPECT_EQ(atlas.bricks.empty(), depth == 0);
            EXPECT_EQ(leaptOver(atlas), 0u) << depth << " " << reach;
            EXPECT_EQ(missedByExits(atlas, 0), 0u) << depth << " " << reach;
        }
}

// The pad is what a ray walked in floats may be off by.
TEST(GridNested, aTriangleThatNearlyTouchesALeafOrAnEmptyVoxelIsListed) {
    for (const auto& [name, mesh, dims] : cases()) {
        const Atlas atlas = build(mesh, dims);
        const Triangles triangles(atlas);
        std::size_t missed = 0;
        for (const Cell& cell : cellsOf(atlas)) {
            const double scale = std::ldexp(1.0, -cell.level);
            const double pad = 0.99 * 0x1p-8;
            const glm::dvec3 lo = (glm::dvec3(cell.at) - pad) * scale;
            const glm::dvec3 hi = (glm::dvec3(cell.at) + 1.0 + pad) * scale;
            const bool leaf = cell.word & kOccupiedBit;
            const std::vector<std::uint32_t> ids =
                leaf ? listOf(atlas, cell.word) : std::vector<std::uint32_t>();
            for (std::uint32_t i = 0; i < triangles.size(); ++i)
                missed += triangles.meets(i, lo, hi) && !std::binary_search(ids.begin(), ids.end(), i);
        }
        EXPECT_EQ(missed, 0u) << name;
    }
}

TEST(GridNested, listsStayShortWhereBricksCanPartTriangles) {
    const Atlas stadium = build(cases()[5].mesh, cases()[5].dims);
    std::size_t longest = 0;
    int finest = 0;
    for (const Cell& cell : cellsOf(stadium)) {
        if (cell.word & kOccupiedBit) longest = std::max(longest, listOf(stadium, cell.word).size());
        finest = std::max(finest, cell.level);
    }
    EXPECT_LE(longest, 3u * NestOptions().leafSize); // of 512
    EXPECT_GE(finest, 7);
}

TEST(GridNested, aVoxelStaysALeafWhereABrickWouldPartNoTriangles) {
    // A brick would list all triangles of the fan again in the voxel of their common vertex.
    const Atlas fan = build(test::makeFan(64), {1, 1, 1});
    const int outermost = bricksOf(fan, "fan")[0].level;
    std::size_t whole = 0;
    for (const Cell& cell : cellsOf(fan)) {
        if (!(cell.word & kOccupiedBit) || listOf(fan, cell.word).size() < 64) continue;
        EXPECT_EQ(cell.level, outermost);
        ++whole;
    }
    EXPECT_GE(whole, 1u);
}

TEST(GridNested, voxelsAreNeverFinerThanTheLimit) {
    // All triangles in one corner of a long grid: only the limit ends the nesting.
    const Mesh mesh = test::joined(test::moved(test::makeSphere(4), 1e-5f, {0.5f, 0.5f, 0.0f}),
                                   test::makeTexturedSquare({}));
    const Atlas atlas = build(mesh, {8192, 4, 1});
    for (const BrickPlace& brick : bricksOf(atlas, "atlas")) EXPECT_LE(8192u << brick.level, kMaxFinestSide);
}

} // namespace
} // namespace rt
