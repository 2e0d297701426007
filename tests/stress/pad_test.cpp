// What the pad is needed for: see the error of the walk in shaders/README.md. Walks stay within their bound,
// and with smaller pads rays fall through sheets whose edges lie beside faces of voxels.
#include "tests/stress/float_walk.h"
#include "tests/stress/ray_targets.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/place_grid.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

using test::RayNumbers;

constexpr double kRoundoff = 0x1p-24;
// In roundoffs of the longest side; products of roundings included.
constexpr double kWalkBound = 7.001;
constexpr double kWalkAndTestBound = 13.001;

GridParams paramsOf(const GridLayout& layout, std::uint32_t structure) {
    GridParams grid{};
    grid.gridLo = glm::vec4(layout.gridLo, 0.0f);
    grid.cellSize = glm::vec4(layout.cellSize, 0.0f);
    grid.cellsPerUnit = glm::vec4(layout.cellsPerUnit, 0.0f);
    grid.worldOffset = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
    grid.dims = glm::uvec4(layout.dims, structure);
    return grid;
}

// Scenes as chooseRebase() leaves them, with cubic voxels. Many just above a power of two: roundings are
// largest there.
GridLayout randomLayout(const glm::uvec3& dims, RayNumbers& numbers) {
    const double longest = 0.5 + (numbers.index(2) ? 0.5 : 0.01) * numbers.unit();
    const double side = std::max({dims.x, dims.y, dims.z});
    BoundsD bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds.lo[axis] = numbers.between(-1.0f, 1.0f) * longest;
        bounds.hi[axis] = bounds.lo[axis] + longest * dims[axis] / side;
    }
    return placeGrid(bounds, dims);
}

// Often from one side of the grid to the other, and along few axes.
double randomDeviation(const GridLayout& layout, const test::FloatWalk& walk, RayNumbers& numbers) {
    glm::vec3 origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
        const float side = static_cast<float>(layout.dims[axis]) * layout.cellSize[axis];
        const std::size_t from = numbers.index(3);
        const float part = from == 0 ? numbers.unit() : 0.02f * numbers.unit() + (from == 1 ? 0.0f : 0.98f);
        origin[axis] = layout.gridLo[axis] + side * part;
        const float run = numbers.index(8) ? side * std::exp2(-3.0f * numbers.unit()) : 0.0f;
        direction[axis] = part < 0.5f ? run : -run;
    }
    if (direction == glm::vec3(0.0f)) direction.x = 1.0f;
    return walk.deviation(origin, direction, numbers);
}

class Pad : public test::Stress {
protected:
    static constexpr std::size_t kGrids = 500;
    static constexpr std::uint64_t kEnough = 60'000; // rays, for one to come near the bound

    static double largestDeviation(const glm::uvec3& dims, std::uint32_t structure) {
        double most = 0.0;
        for (std::size_t g = 0; g < kGrids; ++g) {
            RayNumbers gridNumbers(3, g);
            const GridLayout layout = randomLayout(dims, gridNumbers);
            const test::FloatWalk walk(paramsOf(layout, structure));
            for (std::uint64_t i = 0; i < std::max<std::uint64_t>(test::raysPerCase(), kEnough) / kGrids;
                 ++i) {
                RayNumbers numbers(g, i);
                most = std::max(most, randomDeviation(layout, walk, numbers));
            }
        }
        return most;
    }
};

TEST_F(Pad, WalksStayWithinTheirBound) {
    double most = 0.0;
    for (const auto& [structure, dims] :
         {std::pair(kStructureNested, glm::uvec3(64)), std::pair(kStructureNested, glm::uvec3(65, 33, 17)),
          std::pair(kStructureUniform, glm::uvec3(1025, 513, 700)),
          std::pair(kStructureUniform, glm::uvec3(65536, 16, 16))}) {
        const double deviation = largestDeviation(dims, structure);
        fmt::print("{}, {} voxels: a walk is off by {:.2f} * 2^-24 of the side at most\n",
                   structureName(structure), dims.x, deviation);
        EXPECT_LE(deviation, kWalkBound);
        most = std::max(most, deviation);
    }
    EXPECT_GT(most, 0.5 * kWalkBound); // the bound has a meaning
}

TEST_F(Pad, HoldsTheBoundsOfWalkAndTest) {
    for (const unsigned side : {1u, 64u, 1000u, 4096u, 5000u, 65536u})
        for (int level = 0; level <= finestLevelOf(side); ++level)
            EXPECT_GE(padCellsFor(glm::uvec3(side), level),
                      kWalkAndTestBound * kRoundoff * std::ldexp(side, level));
}

/// A sheet across one axis, of squares as large as voxels of some level, whose corners lie beside corners of
/// those voxels by errors of a walk.
struct SheetPlace {
    const char* name;
    std::uint32_t structure;
    glm::uvec3 dims;
    int level;
    float loWorld; ///< the lowest corner of the scene; its longest side is about 1
    int across;    ///< axis
};

constexpr double kBeside = 2.0; // roundoffs of the longest side

class Sheet {
public:
    explicit Sheet(const SheetPlace& place) : place_(place) {
        side_ = std::max({place.dims.x, place.dims.y, place.dims.z});
        chooseFrame();
        first_ = glm::floor(0.9 * std::ldexp(1.0, place.level) * glm::dvec3(place.dims)) - double(kSquares);
        first_ = glm::max(first_, glm::dvec3(1.0));
        mesh_ = test::joined(frame_, squares());
    }

    Atlas atlas(double padScale) const { return atlasOf(mesh_, padScale); }

    /// Through the sheet beside a corner or an edge, from within the grid or outside, along the faces of
    /// voxels or nearly so.
    QueryRay ray(RayNumbers& numbers) const {
        const glm::dvec3 corner(1 + numbers.index(kSquares - 1), 1 + numbers.index(kSquares - 1), 0.0);
        glm::dvec3 offset = turned({beside(numbers), beside(numbers), 0.0});
        if (!numbers.index(3)) offset[(place_.across + 1) % 3] = 0.4 * voxel(); // an edge
        const double inside = 0.05 * place_.dims[place_.across] / side_;
        const double away = (numbers.index(2) ? inside : 3.0) * (numbers.index(2) ? 1.0 : -1.0);
        glm::dvec3 step{slope(numbers), slope(numbers), 0.0};
        step = turned(step);
        step[place_.across] = away;
        const glm::vec3 target = world(turned(corner) + first_, offset);
        const glm::vec3 direction(-step);
        return test::rayFrom(target - direction, direction);
    }

private:
    static constexpr int kSquares = 12;

    Mesh frameOf(float longest) const {
        const glm::vec3 lo(place_.loWorld);
        const glm::vec3 hi = lo + glm::vec3(place_.dims) * (longest / static_cast<float>(side_));
        const glm::vec3 x(0x1p-10f, 0.0f, 0.0f), y(0.0f, 0x1p-10f, 0.0f);
        return test::makeTriangles({lo, lo + x, lo + y, hi, hi - x, hi - y});
    }
    /// Of several sizes, the one where cellsPerUnit is rounded most.
    void chooseFrame() {
        double most = -1.0;
        for (int i = 1; i <= 40; ++i) {
            const Mesh frame = frameOf(1.0f - 0x1p-10f * static_cast<float>(i));
            const GridParams grid = atlasOf(frame, 1.0).grid;
            double rounding = 1.0;
            for (int axis = 0; axis < 3; ++axis)
                rounding = std::min(
                    rounding, std::abs(double(grid.cellsPerUnit[axis]) * double(grid.cellSize[axis]) - 1.0));
            if (rounding <= most) continue;
            most = rounding;
            frame_ = frame;
            grid_ = grid;
        }
    }
    Atlas atlasOf(const Mesh& mesh, double padScale) const {
        BuildOptions options;
        options.structure = place_.structure;
        options.resolution.exact = place_.dims;
        options.nest = NestOptions{.gridLeafSize = 1, .leafSize = 2, .wordCost = 1e-6};
        options.padScale = padScale;
        StageTimer timer;
        return buildAtlas({mesh, 0}, "mesh", options, timer).atlas;
    }
    /// Side of a voxel of the sheet's level, in voxels of the grid.
    double voxel() const { return std::ldexp(1.0, -place_.level); }
    /// A vector whose z is across the sheet.
    glm::dvec3 turned(const glm::dvec3& v) const {
        glm::dvec3 result;
        for (int i = 0; i < 3; ++i) result[(place_.across + 1 + i) % 3] = v[i];
        return result;
    }
    /// In voxels of the grid.
    double beside(RayNumbers& numbers) const {
        return kBeside * kRoundoff * side_ * numbers.between(-1.0f, 1.0f);
    }
    /// Aside, world units, on the way to the sheet: for one ray in three more than nothing.
    double slope(RayNumbers& numbers) const {
        return numbers.index(3) ? 0.0 : 2.0 * kBeside * kRoundoff * numbers.between(-1.0f, 1.0f);
    }
    /// Of a corner of the level's voxels, moved by `offset` voxels of the grid.
    glm::vec3 world(const glm::dvec3& corner, const glm::dvec3& offset) const {
        const glm::dvec3 inGrid = corner * voxel() + offset;
        const glm::dvec3 atlas =
            glm::dvec3(glm::vec3(grid_.gridLo)) + inGrid * glm::dvec3(glm::vec3(grid_.cellSize));
        return glm::vec3(atlas / double(grid_.worldOffset.w) + glm::dvec3(glm::vec3(grid_.worldOffset)));
    }
    Mesh squares() const {
        std::vector<glm::vec3> positions;
        std::vector<glm::uvec3> triangles;
        RayNumbers numbers(11, 0);
        for (unsigned j = 0; j <= kSquares; ++j)
            for (unsigned i = 0; i <= kSquares; ++i) {
                const glm::dvec3 offset{beside(numbers), beside(numbers), 0.4 * voxel()};
                positions.push_back(world(turned({i, j, 0.0}) + first_, turned(offset)));
                if (i == kSquares || j == kSquares) continue;
                const unsigned at = j * (kSquares + 1) + i, above = at + kSquares + 1;
                triangles.emplace_back(at, at + 1, above + 1);
                triangles.emplace_back(at, above + 1, above);
            }
        return test::makeIndexed(std::move(positions), std::move(triangles));
    }

    SheetPlace place_;
    Mesh frame_;
    double side_; // voxels
    GridParams grid_;
    glm::dvec3 first_; // of the sheet's corners, in voxels of its level
    Mesh mesh_;
};

const SheetPlace kSheets[] = {
    {"uniform, 1024 voxels long", kStructureUniform, {16, 16, 1024}, 0, -0.5f, 0},
    {"uniform, 8192 voxels long", kStructureUniform, {16, 16, 8192}, 0, -0.5f, 1},
    {"cloud, 8192 voxels long, sheet across", kStructureCloud, {16, 16, 8192}, 0, -0.5f, 2},
    {"octant, 8192 voxels long", kStructureOctant, {16, 16, 8192}, 0, 0.0f, 0},
    {"nested, level 12", kStructureNested, {8, 8, 8}, 12, -0.5f, 1},
    {"nested, level 12, a side away", kStructureNested, {7, 7, 7}, 12, 1.0f, 2}};

TEST_F(Pad, RaysAreLostWhereItIsSmaller) {
    for (const SheetPlace& place : kSheets) {
        const Sheet sheet(place);
        for (const double padScale : {0.0, 1.0 / 16.0, 1.0 / 4.0, 1.0}) {
            const Atlas atlas = sheet.atlas(padScale);
            const test::StressCase stress{fmt::format("{}, pad times {}", place.name, padScale), atlas,
                                          [&](RayNumbers& numbers) { return sheet.ray(numbers); }};
            const test::Tally tally = watertight(stress);
            report(stress, "watertight", tally);
            if (padScale == 0.0) {
                EXPECT_GT(tally.wrong, 0u) << stress.name;
            }
            if (padScale < 1.0) continue;
            EXPECT_EQ(tally.wrong, 0u) << stress.name << ": " << tally.firstWrong;
        }
    }
}

} // namespace
} // namespace rt
