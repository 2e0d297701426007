// rt-grid --dry-run against what builds then take.
#include "common/error.h"
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-grid/forecast_build.h"

#include <gmock/gmock.h>
#include <tbb/task_arena.h>

namespace rt {
namespace {

struct Case {
    const char* name;
    Mesh mesh;
};

std::vector<Case> cases() {
    return {{"sphere", test::makeSphere(6)},
            {"random triangles", test::makeRandomTriangles(20000, 1, 0.05f)},
            {"slivers and giants", test::makeSliversAndGiants(400)},
            {"dense in sparse", test::joined(test::moved(test::makeSphere(6), 0.002f, {0.31f, 0.52f, 0.001f}),
                                             test::makeTexturedSquare({}))},
            {"textured", test::makeTexturedSquare({{5, 9}, {30, 2}})}};
}

double ratio(std::uint64_t forecast, std::uint64_t built) {
    return static_cast<double>(forecast) / static_cast<double>(built);
}

BuildForecast forecastOf(const Mesh& mesh, const BuildOptions& options) {
    StageTimer timer;
    return forecastBuild(MeshFile{mesh, 77}, "mesh", options, timer);
}

TEST(GridForecast, flatGridsAreForecastExactlyAndBricksClosely) {
    for (const auto& [name, mesh] : cases())
        for (const std::uint32_t structure :
             {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested})
            for (const Quality quality : {Quality::fast, Quality::balanced, Quality::best}) {
                BuildOptions options;
                options.structure = structure;
                options.quality = quality;
                StageTimer timer;
                const Atlas atlas = buildAtlas(MeshFile{mesh, 77}, "mesh", options, timer).atlas;
                const BuildForecast forecast = forecastOf(mesh, options);
                const double off = structure == kStructureNested ? 0.1 : 0.0;
                const std::string where = std::string(name) + ", " + structureName(structure);
                EXPECT_EQ(forecast.refusal, "");
                EXPECT_EQ(forecast.structure, structure);
                EXPECT_EQ(forecast.sizes.dims, glm::uvec3(atlas.grid.dims)) << where;
                EXPECT_NEAR(ratio(forecast.references, atlas.info.references), 1.0, off) << where;
                EXPECT_NEAR(ratio(forecast.occupiedVoxels, atlas.info.occupiedVoxels), 1.0, off) << where;
                EXPECT_NEAR(
                    ratio(fileBytesOf(sectionsOf(forecast.sizes)), fileBytesOf(sectionsOf(sizesOf(atlas)))),
                    1.0, off)
                    << where;
                if (!atlas.bricks.empty()) {
                    EXPECT_NEAR(ratio(forecast.sizes.brickWords, atlas.bricks.size()), 1.0, off) << where;
                    EXPECT_NEAR(ratio(forecast.bricks, bricksOf(atlas, "atlas").size()), 1.0, off) << where;
                }
            }
}

TEST(GridForecast, autoChoosesAsTheBuildDoes) {
    for (const auto& [name, mesh] : cases()) {
        StageTimer timer;
        const BuiltAtlas built = buildAtlas(MeshFile{mesh, 77}, "mesh", {}, timer);
        EXPECT_EQ(forecastOf(mesh, {}).structure, built.atlas.grid.dims.w) << name;
    }
}

TEST(GridForecast, doesNotDependOnThreads) {
    BuildOptions options;
    options.structure = kStructureNested;
    const Mesh mesh = test::makeRandomTriangles(20000, 1, 0.05f);
    const BuildForecast all = forecastOf(mesh, options);
    tbb::task_arena one(1);
    const BuildForecast alone = one.execute([&] { return forecastOf(mesh, options); });
    EXPECT_EQ(all.sizes.brickWords, alone.sizes.brickWords);
    EXPECT_EQ(all.references, alone.references);
}

TEST(GridForecast, refusesWhatTheBuildRefuses) {
    const Mesh mesh = test::makeRandomTriangles(5000, 2, 0.3f);
    int refused = 0, built = 0;
    for (const std::uint32_t structure : {kStructureUniform, kStructureOctant, kStructureNested})
        for (std::uint64_t bytes = 1u << 19; bytes < 1u << 28; bytes = bytes * 3 / 2) {
            BuildOptions options;
            options.structure = structure;
            options.memory = {bytes, "--max-memory"};
            std::string refusal, forecastRefusal;
            try {
                StageTimer timer;
                buildAtlas(MeshFile{mesh, 77}, "mesh", options, timer);
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
                refusal = error.what();
            }
            try {
                forecastRefusal = forecastOf(mesh, options).refusal;
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
                forecastRefusal = error.what();
            }
            EXPECT_EQ(forecastRefusal, refusal) << structureName(structure) << " " << bytes;
            ++(refusal.empty() ? built : refused);
            if (!refusal.empty()) {
                EXPECT_THAT(refusal, testing::HasSubstr("raise --max-memory"));
            }
        }
    EXPECT_GT(refused, 10);
    EXPECT_GT(built, 10);
}

} // namespace
} // namespace rt
