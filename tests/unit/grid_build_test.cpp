#include "common/binary_io.h"
#include "common/error.h"
#include "formats/octahedral.shared.h"
#include "tests/support/make_mesh.h"
#include "tests/support/temporary_folder.h"
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-grid/vdb_export.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace rt {
namespace {

BuildOptions optionsFor(std::uint32_t structure, const glm::uvec3& dims) {
    BuildOptions options;
    options.structure = structure;
    options.resolution.exact = dims;
    return options;
}

Atlas build(const Mesh& mesh, const BuildOptions& options) {
    StageTimer timer;
    return buildAtlas(MeshFile{mesh, 77}, "mesh", options, timer).atlas;
}

#ifdef __SANITIZE_ADDRESS__
constexpr bool kCountsMemory = false; // the sanitizer's own would count
#else
constexpr bool kCountsMemory = true;
#endif

template <class T>
bool sameBytes(const SharedSpan<T>& a, const SharedSpan<T>& b) {
    return std::ranges::equal(bytesOf<T>(a), bytesOf<T>(b)); // memcmp must not get the null of an empty array
}

std::string messageOf(const Mesh& mesh, const BuildOptions& options) {
    try {
        build(mesh, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        return error.what();
    }
    return "";
}

TEST(GridBuild, atlasesAreValidForBothStructuresAndManyMeshes) {
    const Mesh degenerate =
        test::makeTriangles({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 2, 3}, {0.5f, 1, 1.5f}});
    for (const Mesh& mesh : {test::makeCube(), test::makeSphere(3), test::makeRandomTriangles(500, 1),
                             test::makeTexturedSquare({{5, 9}, {30, 2}}), degenerate})
        for (const std::uint32_t structure :
             {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested})
            for (const glm::uvec3 dims : {glm::uvec3(1), glm::uvec3(13, 5, 8), glm::uvec3(1, 64, 3)})
                EXPECT_NO_THROW(validate(build(mesh, optionsFor(structure, dims)), "atlas"));
}

TEST(GridBuild, listsStandInVoxelOrderWithoutGapsAndAscend) {
    const Atlas atlas =
        build(test::makeRandomTriangles(3000, 5, 0.2f), optionsFor(kStructureCloud, glm::uvec3(17, 19, 23)));
    std::uint64_t next = 0;
    std::uint64_t occupied = 0;
    for (const std::uint32_t word : atlas.voxels) {
        if (!(word & kOccupiedBit)) continue;
        ASSERT_EQ(leafList(word), next);
        EXPECT_EQ(atlas.references[next], 0u) << "an exit box";
        std::vector<std::uint32_t> list;
        copyTriangles(atlas.references, next, list);
        EXPECT_EQ(std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()), list.end());
        next += 1 + list.size();
        ++occupied;
    }
    EXPECT_EQ(next, atlas.references.size());
    EXPECT_EQ(atlas.info.occupiedVoxels, occupied);
    EXPECT_EQ(atlas.info.references, atlas.references.size() - occupied);
}

TEST(GridBuild, carriesWhatTheMeshSays) {
    const Mesh mesh = test::moved(test::makeTexturedSquare({{4, 4}}), 10.0f, glm::vec3(100.0f, 0.0f, -3.0f));
    const Atlas atlas = build(mesh, optionsFor(kStructureUniform, glm::uvec3(4, 4, 1)));
    EXPECT_EQ(atlas.info.meshHash, 77u);
    EXPECT_EQ(atlas.info.worldLo[0], 100.0);
    EXPECT_EQ(atlas.info.worldHi[1], 10.0);
    EXPECT_EQ(atlas.info.worldHi[2], -3.0);
    EXPECT_EQ(atlas.info.maxDistance, 0u);
    EXPECT_EQ(atlas.info.padCells, 0x1p-8);
    EXPECT_EQ(atlas.grid.dims, glm::uvec4(4, 4, 1, kStructureUniform));
    EXPECT_EQ(atlas.grid.counts, glm::uvec4(2, 4, 1, 0));
    EXPECT_EQ(atlas.triangleVertices[1], glm::uvec4(0, 2, 3, 0));
    EXPECT_EQ(atlas.normals[2], octEncode(glm::vec3(0.0f, 0.0f, 1.0f)));
    EXPECT_EQ(atlas.texcoords[2], glm::vec2(1.0f));
    EXPECT_EQ(atlas.materials[0].images.x, 0u);
    EXPECT_EQ(glm::uvec3(atlas.info.pageWidth, atlas.info.pageHeight, atlas.info.pageCount),
              glm::uvec3(8, 4, 1)); // the smaller levels stand at the right
    EXPECT_EQ(atlas.pages[9], mesh.pixels[5]);
}

TEST(GridBuild, leavesTexturesOutWhereNothingShowsThem) {
    Mesh mesh = test::makeTexturedSquare({{4, 4}});
    mesh.texcoords = {};
    const Atlas withoutCoordinates = build(mesh, optionsFor(kStructureCloud, glm::uvec3(2)));
    EXPECT_EQ(withoutCoordinates.materials[0].images.x, kNoImage);
    EXPECT_TRUE(withoutCoordinates.pages.empty());
    mesh = test::makeTexturedSquare({{4, 4}});
    mesh.materials = std::vector<Material>{test::greyMaterial()};
    const Atlas unused = build(mesh, optionsFor(kStructureCloud, glm::uvec3(2)));
    EXPECT_TRUE(unused.pages.empty() && unused.images.empty() && unused.texcoords.empty());
}

TEST(GridBuild, bytesDoNotDependOnTheNumberOfThreads) {
    const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                      4); // on small machines too
    const Mesh mesh = test::makeRandomTriangles(60000, 9, 0.08f);
    tbb::task_arena one(1);
    for (const BuildOptions& options : {optionsFor(kStructureCloud, glm::uvec3(64, 63, 65)),
                                        optionsFor(kStructureNested, glm::uvec3(9, 10, 11))}) {
        const Atlas a = one.execute([&] { return build(mesh, options); });
        for (const int threads : {2, 4}) {
            tbb::task_arena several(threads);
            const Atlas b = several.execute([&] { return build(mesh, options); });
            EXPECT_EQ(std::memcmp(&a.info, &b.info, sizeof a.info), 0);
            EXPECT_EQ(std::memcmp(&a.grid, &b.grid, sizeof a.grid), 0);
            EXPECT_TRUE(sameBytes(a.voxels, b.voxels));
            EXPECT_TRUE(sameBytes(a.bricks, b.bricks));
            EXPECT_TRUE(sameBytes(a.references, b.references));
            EXPECT_TRUE(sameBytes(a.triangles, b.triangles));
            EXPECT_EQ(vdbBytes(a), vdbBytes(b));
        }
    }
}

TEST(GridLimits, aBillionVoxelsAreRefusedWithTheRequestAndTheLimit) {
    BuildOptions options = optionsFor(kStructureCloud, glm::uvec3(1000));
    options.memory = {~std::uint64_t(0), "test"};
    const std::string message = messageOf(test::makeCube(), options);
    EXPECT_THAT(message, testing::HasSubstr("1000x1000x1000 = 1000000000"));
    EXPECT_THAT(message, testing::HasSubstr("536870912"));
    options.resolution.exact = glm::uvec3(65536);
    EXPECT_THAT(messageOf(test::makeCube(), options), testing::HasSubstr("281474976710656"));
}

TEST(GridLimits, memoryIsForecastBeforeItIsTaken) {
    BuildOptions options = optionsFor(kStructureCloud, glm::uvec3(512));
    options.memory = {100u << 20, "--max-memory"};
    const std::string message = messageOf(test::makeCube(), options);
    EXPECT_THAT(message, testing::HasSubstr("needs at least 513 MiB"));
    EXPECT_THAT(message, testing::HasSubstr("the limit is 100 MiB (--max-memory)"));
    EXPECT_TRUE(!kCountsMemory || peakMemoryBytes() < (450u << 20));
}

TEST(GridLimits, oneGiantTriangleStopsBeforeItFillsTheMemory) {
    const std::vector<TriangleRecord> triangles{{.v0 = {0, 0, 0, 0}, .v1 = {1, 0, 0, 0}, .v2 = {0, 1, 0, 0}}};
    const GridLayout layout = placeGrid(gridBounds(triangles), glm::uvec3(16384, 16384, 1));
    WorkMeter meter;
    EXPECT_THROW(binTriangles(triangles, layout, {1000, "too many"}, meter), Error); // of 2^27
    EXPECT_TRUE(!kCountsMemory || peakMemoryBytes() < (300u << 20));
}

TEST(GridLimits, theControlGroupsLimitCounts) {
    const test::TemporaryFolder folder;
    const auto bytesWith = [&](const std::string& name, std::string_view text) {
        writeFile(folder.file(name), text);
        return defaultMemoryLimit(folder.file("")).bytes;
    };
    const std::uint64_t machine = defaultMemoryLimit(folder.file("none")).bytes;
    EXPECT_GT(machine, 0u);
    EXPECT_EQ(bytesWith("memory.max", "max\n"), machine);
    EXPECT_EQ(bytesWith("memory.max", "4194304\n"), 3u << 20);
    std::filesystem::create_directory(folder.file("memory"));
    EXPECT_EQ(bytesWith("memory/memory.limit_in_bytes", "9223372036854771712\n"), 3u << 20);
    EXPECT_EQ(bytesWith("memory/memory.limit_in_bytes", "2097152\n"), 3u << 19);
}

TEST(GridLimits, listsStopGrowingAtTheLimit) {
    // 64^3 voxels of 4 bytes leave room for 40 references per triangle; these triangles need hundreds.
    const Mesh mesh = test::makeRandomTriangles(2000, 4, 0.5f);
    BuildOptions options = optionsFor(kStructureCloud, glm::uvec3(64));
    options.memory = {(1u << 20) + 2000u * (68u + 12u + 480u), "--max-memory"};
    EXPECT_THAT(messageOf(mesh, options), testing::HasSubstr("triangle references"));
    options.memory = defaultMemoryLimit();
    EXPECT_NO_THROW(build(mesh, options));
}

TEST(GridLimits, bricksStopGrowingAtTheLimit) {
    const Mesh mesh = test::makeRandomTriangles(2000, 4, 0.05f);
    BuildOptions options = optionsFor(kStructureNested, glm::uvec3(4));
    options.memory = {2000u * (80u + 12u * 3u), "--max-memory"}; // 4^3 voxels take no more than 2 of the 3
    EXPECT_THAT(messageOf(mesh, options), testing::HasSubstr("brick words"));
    options.memory = defaultMemoryLimit();
    EXPECT_NO_THROW(build(mesh, options));
}

} // namespace
} // namespace rt
