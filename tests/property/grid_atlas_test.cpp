// What a traversal relies on, checked on whole builds of varied meshes.
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
};

std::vector<Case> cases() {
    return {{"sphere", test::makeSphere(4)},
            {"far sphere", test::moved(test::makeSphere(4), 1.0f, glm::vec3(148376, 1234, -223423))},
            {"small triangles", test::makeRandomTriangles(4000, 1, 0.02f)},
            {"large triangles", test::makeRandomTriangles(300, 2, 0.5f)},
            {"slivers and giants", test::makeSliversAndGiants(300)},
            {"box", test::makeBox(glm::vec3(-1.0f, 2.0f, 0.0f), glm::vec3(3.0f, 2.5f, 1.0f))},
            {"flat", test::makeTexturedSquare({})}};
}

Atlas build(const Mesh& mesh, const glm::uvec3& dims) {
    BuildOptions options;
    options.structure = kStructureCloud;
    options.resolution.exact = dims;
    StageTimer timer;
    return buildAtlas(MeshFile{mesh, 0}, "mesh", options, timer).atlas;
}

std::size_t voxelIndex(const Atlas& atlas, const glm::ivec3& v) {
    const glm::uvec4& dims = atlas.grid.dims;
    return (static_cast<std::size_t>(v.z) * dims.y + static_cast<std::size_t>(v.y)) * dims.x +
           static_cast<std::size_t>(v.x);
}

bool lists(const Atlas& atlas, const glm::ivec3& voxel, std::uint32_t triangle) {
    const std::uint32_t word = atlas.voxels[voxelIndex(atlas, voxel)];
    if (!(word & kOccupiedBit)) return false;
    std::vector<std::uint32_t> list;
    copyTriangles(atlas.references, leafList(word), list);
    return std::binary_search(list.begin(), list.end(), triangle);
}

// A point of the triangle: anywhere, on an edge, or a corner.
glm::dvec3 pointOn(const TriangleRecord& t, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double b1 = unit(random);
    double b2 = unit(random);
    if (b1 + b2 > 1.0) b1 = 1.0 - b1, b2 = 1.0 - b2;
    if (random() % 4 == 0) b1 = 0.0;
    if (random() % 4 == 0) b2 = 0.0;
    const glm::dvec3 origin(t.v0);
    return origin + b1 * (glm::dvec3(t.v1) - origin) + b2 * (glm::dvec3(t.v2) - origin);
}

TEST(GridAtlas, theVoxelOfEveryPointOfATriangleListsIt) {
    std::mt19937_64 random(11);
    for (const auto& [name, mesh] : cases())
        for (const glm::uvec3 dims : {glm::uvec3(1), glm::uvec3(37, 21, 50), glm::uvec3(128, 3, 77)}) {
            const Atlas atlas = build(mesh, dims);
            const std::size_t perTriangle = std::max<std::size_t>(4, 20000 / atlas.triangles.size());
            std::size_t missed = 0;
            for (std::uint32_t i = 0; i < atlas.triangles.size(); ++i)
                for (std::size_t k = 0; k < perTriangle; ++k) {
                    const glm::dvec3 p = pointOn(atlas.triangles[i], random);
                    const glm::dvec3 cells =
                        (p - glm::dvec3(atlas.grid.gridLo)) / glm::dvec3(atlas.grid.cellSize);
                    const glm::ivec3 voxel(glm::floor(cells));
                    ASSERT_TRUE(voxel.x >= 0 && voxel.y >= 0 && voxel.z >= 0);
                    ASSERT_TRUE(glm::all(glm::lessThan(glm::uvec3(voxel), dims)));
                    missed += !lists(atlas, voxel, i);
                }
            EXPECT_EQ(missed, 0u) << name;
        }
}

// Counts occupied voxels in boxes: sums over all voxels before each corner.
class OccupiedSums {
public:
    explicit OccupiedSums(const Atlas& atlas) : dims_(atlas.grid.dims), size_(dims_ + 1) {
        sums_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                     static_cast<std::size_t>(size_.z));
        for (int z = 0; z < dims_.z; ++z)
            for (int y = 0; y < dims_.y; ++y)
                for (int x = 0; x < dims_.x; ++x) {
                    const bool occupied = atlas.voxels[voxelIndex(atlas, {x, y, z})] & kOccupiedBit;
                    at(x + 1, y + 1, z + 1) = at(x, y + 1, z + 1) + at(x + 1, y, z + 1) +
                                              at(x + 1, y + 1, z) - at(x, y, z + 1) - at(x, y + 1, z) -
                                              at(x + 1, y, z) + at(x, y, z) + occupied;
                }
    }
    // Occupied voxels within chessboard distance `radius` of the voxel.
    long within(const glm::ivec3& voxel, int radius) {
        const glm::ivec3 a = glm::max(voxel - radius, glm::ivec3(0));
        const glm::ivec3 b = glm::min(voxel + radius + 1, dims_);
        return at(b.x, b.y, b.z) - at(a.x, b.y, b.z) - at(b.x, a.y, b.z) - at(b.x, b.y, a.z) +
               at(a.x, a.y, b.z) + at(a.x, b.y, a.z) + at(b.x, a.y, a.z) - at(a.x, a.y, a.z);
    }

private:
    long& at(int x, int y, int z) { return sums_[static_cast<std::size_t>((z * size_.y + y) * size_.x + x)]; }
    glm::ivec3 dims_;
    glm::ivec3 size_;
    std::vector<long> sums_;
};

TEST(GridAtlas, everyEmptyRadiusIsEmptyAndCannotGrow) {
    for (const auto& [name, mesh] : cases()) {
        const Atlas atlas = build(mesh, {61, 47, 53});
        OccupiedSums occupied(atlas);
        std::size_t leapsOverTriangles = 0;
        std::size_t tooShort = 0;
        for (int z = 0; z < 53; ++z)
            for (int y = 0; y < 47; ++y)
                for (int x = 0; x < 61; ++x) {
                    const std::uint32_t word = atlas.voxels[voxelIndex(atlas, {x, y, z})];
                    if (word & kOccupiedBit) continue;
                    const auto distance = static_cast<int>(word);
                    leapsOverTriangles += occupied.within({x, y, z}, distance - 1) != 0;
                    tooShort += occupied.within({x, y, z}, distance) == 0;
                }
        EXPECT_EQ(leapsOverTriangles, 0u) << name;
        EXPECT_EQ(tooShort, 0u) << name;
    }
}

} // namespace
} // namespace rt
