#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"

#include <gtest/gtest.h>

namespace rt {
namespace {

BuiltAtlas build(const Mesh& mesh, Quality quality = Quality::balanced) {
    BuildOptions options;
    options.quality = quality;
    StageTimer timer;
    return buildAtlas(MeshFile{mesh, 0}, "mesh", options, timer);
}

// A small dense object and a triangle, a thousand times as large, on which it stands.
Mesh teapotInAStadium() {
    return test::joined(test::makeSphere(5),
                        test::makeTriangles({{-1000, -1, -1000}, {1000, -1, -1000}, {0, -1, 1000}}));
}

TEST(ChooseStructure, nestedWhereDensityVaries) {
    for (const Quality quality : {Quality::fast, Quality::balanced, Quality::best}) {
        const BuiltAtlas built = build(teapotInAStadium(), quality);
        ASSERT_TRUE(built.choice);
        EXPECT_EQ(built.atlas.grid.dims.w, kStructureNested);
        EXPECT_LT(built.choice->nested.cost(), 0.5 * built.choice->octant.cost());
    }
}

TEST(ChooseStructure, takesWhatItForecastsToBeCheaper) {
    for (const Mesh& mesh :
         {test::makeRandomTriangles(2000, 1, 0.02f), test::makeRandomTriangles(2000, 2, 0.5f),
          test::makeSphere(5), test::makeRandomTriangles(1, 3, 0.5f)}) {
        const BuiltAtlas built = build(mesh);
        const bool octant = built.choice->octant.cost() < built.choice->nested.cost();
        EXPECT_EQ(built.atlas.grid.dims.w, octant ? kStructureOctant : kStructureNested);
    }
}

TEST(ChooseStructure, forecastsFewerTestsForMoreVoxels) {
    const Mesh sphere = test::makeSphere(5);
    const auto fast = build(sphere, Quality::fast).choice;
    const auto best = build(sphere, Quality::best).choice;
    EXPECT_LT(best->nested.tests, fast->nested.tests);
    EXPECT_LT(best->octant.tests, fast->octant.tests);
}

TEST(ChooseStructure, aGivenStructureIsTaken) {
    BuildOptions options;
    options.structure = kStructureUniform;
    StageTimer timer;
    const BuiltAtlas built = buildAtlas(MeshFile{teapotInAStadium(), 0}, "mesh", options, timer);
    EXPECT_FALSE(built.choice);
    EXPECT_EQ(built.atlas.grid.dims.w, kStructureUniform);
}

} // namespace
} // namespace rt
