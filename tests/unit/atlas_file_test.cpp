// .rtatlas: what is written comes back, and a file that was damaged anywhere is refused.
#include "formats/atlas_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/format_files.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

namespace rt::test {
namespace {

Atlas smallAtlas() {
    Atlas atlas;
    atlas.grid.gridLo = glm::vec4(-0.25f, -0.25f, -0.25f, 0.0f);
    atlas.grid.cellSize = glm::vec4(1.5f, 1.5f, 1.0f, 0.0f);
    atlas.grid.cellsPerUnit = glm::vec4(1 / 1.5f, 1 / 1.5f, 1.0f, 0.0f);
    atlas.grid.worldOffset = glm::vec4(0, 0, 0, 0.5f);
    atlas.grid.dims = glm::uvec4(2, 1, 1, kStructureCloud);
    atlas.grid.counts = glm::uvec4(2, 4, 1, 1);
    atlas.voxels = std::vector<std::uint32_t>{kOccupiedBit | 0u, 1u};
    atlas.references = std::vector<std::uint32_t>{0, 0, kLastInList | 1};
    std::vector<TriangleRecord> triangles(2);
    triangles[0] = {{0, 0, 0, 0}, {0.5f, 0, 0, 0}, {0, 0.5f, 0, 0}};
    triangles[1] = {{0.5f, 0, 0, std::bit_cast<float>(1u)}, {0.5f, 0.5f, 0.25f, 0}, {0, 0.5f, 0, 0}};
    atlas.triangles = std::move(triangles);
    atlas.triangleVertices = std::vector<glm::uvec4>{{0, 1, 2, 0}, {1, 3, 2, 0}};
    atlas.normals = std::vector<std::uint32_t>(4, 0u);
    atlas.texcoords = std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    atlas.materials = std::vector<Material>{greyMaterial(0)};
    atlas.lights = std::vector<Light>{pointLight({1, 2, 3}, {4, 5, 6})};
    atlas.images = std::vector<ImagePlace>{{{0, 0, 2, 1}, {0, 0, 0, 0}}};
    atlas.pages = std::vector<std::uint32_t>{0xFF0000FFu, 0xFF00FF00u, 0xFF008080u};
    atlas.info.pageWidth = 3;
    atlas.info.pageHeight = atlas.info.pageCount = 1;
    return atlas;
}

// One voxel holds a brick of 2^3 voxels, of which one lists both triangles and one holds a brick that lists
// one.
Atlas smallNestedAtlas() {
    Atlas atlas = smallAtlas();
    atlas.grid.dims.w = kStructureNested;
    atlas.voxels = std::vector<std::uint32_t>{brickWord(0, 1), freeBoxWord({0, 31, 31}, {31, 31, 31})};
    std::vector<std::uint32_t> bricks(16, freeBoxWord({0, 0, 0}, {0, 0, 0}));
    bricks[3] = brickWord(8, 1);
    bricks[5] = leafWord(0);
    bricks[8] = leafWord(3);
    atlas.bricks = std::move(bricks);
    atlas.references =
        std::vector<std::uint32_t>{0, 0, kLastInList | 1, freeBoxWord({1, 2, 3}, {4, 5, 6}), kLastInList | 1};
    return atlas;
}

TEST(AtlasFile, ComesBackAsItWasWritten) {
    const TemporaryFolder folder;
    Atlas atlas = smallAtlas();
    addScenery(atlas);
    writeAtlas(folder.file("a.rtatlas"), atlas);
    const Atlas back = readAtlas(folder.file("a.rtatlas")).atlas;
    EXPECT_EQ(std::memcmp(&back.grid, &atlas.grid, sizeof(GridParams)), 0);
    EXPECT_EQ(std::memcmp(&back.info, &atlas.info, sizeof(AtlasInfo)), 0);
    EXPECT_EQ(bytes(back.voxels), bytes(atlas.voxels));
    EXPECT_EQ(bytes(back.references), bytes(atlas.references));
    EXPECT_TRUE(back.bricks.empty());
    EXPECT_EQ(bytes(back.triangles), bytes(atlas.triangles));
    EXPECT_EQ(bytes(back.triangleVertices), bytes(atlas.triangleVertices));
    EXPECT_EQ(bytes(back.normals), bytes(atlas.normals));
    EXPECT_EQ(bytes(back.texcoords), bytes(atlas.texcoords));
    EXPECT_EQ(bytes(back.materials), bytes(atlas.materials));
    EXPECT_EQ(bytes(back.lights), bytes(atlas.lights));
    EXPECT_EQ(bytes(back.images), bytes(atlas.images));
    EXPECT_EQ(bytes(back.pages), bytes(atlas.pages));
    EXPECT_EQ(bytes(back.cameraKeys), bytes(atlas.cameraKeys));
    EXPECT_EQ(bytes(back.surroundings), bytes(atlas.surroundings));
    EXPECT_EQ(bytes(back.environment), bytes(atlas.environment));
}

TEST(AtlasFile, BricksComeBackAsTheyWereWritten) {
    const TemporaryFolder folder;
    const Atlas atlas = smallNestedAtlas();
    writeAtlas(folder.file("a.rtatlas"), atlas);
    const Atlas back = readAtlas(folder.file("a.rtatlas")).atlas;
    EXPECT_EQ(bytes(back.voxels), bytes(atlas.voxels));
    EXPECT_EQ(bytes(back.bricks), bytes(atlas.bricks));
    EXPECT_EQ(bytes(back.references), bytes(atlas.references));
    const std::vector<BrickPlace> places = bricksOf(back, "a");
    ASSERT_EQ(places.size(), 2u);
    EXPECT_EQ(places[1].offset, 8u);
    EXPECT_EQ(places[1].level, 2);
    EXPECT_EQ(places[1].depth, 2);
    EXPECT_EQ(places[1].first, glm::ivec3(2, 2, 0));
}

TEST(AtlasFile, EveryDamageIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.rtatlas");
    writeAtlas(path, smallAtlas());
    expectEveryDamageIsRefused(path, [&] { readAtlas(path); });
    writeAtlas(path, smallNestedAtlas());
    expectEveryDamageIsRefused(path, [&] { readAtlas(path); });
}

TEST(AtlasFile, SizesAreValidatedWithoutTheContents) {
    const auto refused = [](const std::function<void(Atlas&)>& spoil) {
        Atlas atlas = smallAtlas();
        spoil(atlas);
        return failureOf([&] { validateSizes(atlas, "a"); }) == ErrorKind::InvalidContent;
    };
    using Words = std::vector<std::uint32_t>;
    EXPECT_FALSE(refused([](Atlas& a) {
        a.voxels = Words{~0u, ~0u};
        a.references = Words{~0u};
        a.triangleVertices = std::vector<glm::uvec4>(2, glm::uvec4(~0u));
    }));
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.dims.x = 3; })) << "voxels";
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.counts.x = 1; })) << "counts";
    EXPECT_TRUE(refused([](Atlas& a) { a.triangleVertices = std::vector<glm::uvec4>(1); })) << "TVTX";
    EXPECT_TRUE(refused([](Atlas& a) { a.texcoords = std::vector<glm::vec2>(3); })) << "TEXC";
    EXPECT_TRUE(refused([](Atlas& a) { a.info.pageCount = 2; })) << "pages";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.pages = Words{};
        a.info.pageWidth = 0;
    })) << "pages of no width";
}

TEST(AtlasFile, InvalidBricksWithRightChecksumsAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.rtatlas");
    const auto refused = [&](const std::function<void(Atlas&, std::vector<std::uint32_t>&)>& spoil) {
        Atlas atlas = smallNestedAtlas();
        std::vector<std::uint32_t> bricks(atlas.bricks.begin(), atlas.bricks.end());
        spoil(atlas, bricks);
        atlas.bricks = std::move(bricks);
        writeAtlas(path, atlas);
        return failureOf([&] { readAtlas(path); }) == ErrorKind::InvalidContent;
    };
    using Words = std::vector<std::uint32_t>;
    EXPECT_FALSE(refused([](Atlas&, Words&) {}));
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[3] = brickWord(0, 1); })) << "a brick in itself";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[4] = brickWord(8, 1); })) << "a brick in two voxels";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[3] = 0; })) << "a brick in no voxel";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[3] = brickWord(8, 2); })) << "a brick overruns its section";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b.resize(12); })) << "a brick is cut off";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b.resize(24); })) << "words behind the last brick";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[3] = brickWord(8, 0); })) << "a brick of one voxel";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[3] = brickWord(8, 6); })) << "a brick too large";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[0] = 0x40000000u; })) << "no such tag";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[5] = leafWord(1); })) << "leaf into the middle of a list";
    EXPECT_TRUE(refused([](Atlas&, Words& b) { b[5] = leafWord(5); })) << "leaf beyond the lists";
    EXPECT_TRUE(refused([](Atlas& a, Words&) { a.voxels = Words{brickWord(0, 1), leafWord(9)}; })) << "voxel";
    EXPECT_TRUE(refused([](Atlas& a, Words&) { a.voxels = Words{brickWord(8, 1), 0}; })) << "first brick";
    const auto refusesList = [&](Words list) { // the second one
        return refused([&](Atlas& a, Words&) {
            list.insert(list.begin(), {0, 0, kLastInList | 1});
            a.references = Words(list);
        });
    };
    EXPECT_FALSE(refusesList({0, kLastInList | 1}));
    EXPECT_TRUE(refusesList({0, 1})) << "list overruns";
    EXPECT_TRUE(refusesList({0, kLastInList | 2})) << "no triangle";
    EXPECT_TRUE(refusesList({1u << 31, kLastInList | 1})) << "exit box";
    EXPECT_TRUE(refusesList({1u << 30, kLastInList | 1})) << "exit box of a brick's tag";
    EXPECT_TRUE(refusesList({0, kLastInList | 1, 0})) << "a header alone";
    EXPECT_TRUE(refused([](Atlas& a, Words&) { a.grid.dims.w = kStructureCloud; })) << "bricks in a cloud";
}

TEST(AtlasFile, VoxelsFinerThanTheLimitAreRefused) {
    Atlas atlas = smallNestedAtlas();
    std::vector<std::uint32_t> bricks(4 * 32768, 0u); // 2 * 2^20 voxels a side
    for (std::uint32_t i = 0; i < 3; ++i) bricks[i * 32768] = brickWord((i + 1) * 32768, 5);
    bricks.resize(3 * 32768);
    bricks[2 * 32768] = 0;
    atlas.voxels = std::vector<std::uint32_t>{brickWord(0, 5), 0};
    atlas.bricks = std::vector<std::uint32_t>(bricks);
    EXPECT_NO_THROW(validate(atlas, "a"));
    bricks[2 * 32768] = brickWord(3 * 32768, 5);
    bricks.resize(4 * 32768);
    atlas.bricks = std::move(bricks);
    EXPECT_THROW(validate(atlas, "a"), Error);
}

TEST(AtlasFile, InvalidContentWithRightChecksumsIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.rtatlas");
    const auto refused = [&](const std::function<void(Atlas&)>& spoil) {
        Atlas atlas = smallAtlas();
        spoil(atlas);
        writeAtlas(path, atlas);
        return failureOf([&] { readAtlas(path); }) == ErrorKind::InvalidContent;
    };
    EXPECT_FALSE(refused([](Atlas& a) { addScenery(a); }));
    for (const auto& [what, spoil] : wrongScenery<Atlas>())
        EXPECT_TRUE(refused([&, s = spoil](Atlas& a) {
            addScenery(a);
            s(a);
        })) << what;
    using Words = std::vector<std::uint32_t>;
    EXPECT_TRUE(refused([](Atlas& a) {
        a.voxels = Words{kOccupiedBit | 1u, 1u};
    })) << "voxel into the middle of a list";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.voxels = Words{kOccupiedBit | 3u, 1u};
    })) << "voxel beyond the lists";
    EXPECT_TRUE(refused([](Atlas& a) { a.voxels = Words{kOccupiedBit, 0u}; })) << "a leap of no length";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.voxels = Words{kOccupiedBit, 3u};
    })) << "a leap longer than the grid";
    EXPECT_TRUE(refused([](Atlas& a) { a.voxels = Words{kOccupiedBit}; })) << "a voxel too few";
    EXPECT_TRUE(refused([](Atlas& a) { a.references = Words{0, 0, 1}; })) << "list overruns";
    EXPECT_TRUE(refused([](Atlas& a) { a.references = Words{0, 0, kLastInList | 2}; })) << "no such triangle";
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.counts.w = 2; })) << "light count";
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.dims.w = 9; })) << "structure";
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.cellsPerUnit.x = 2.0f; })) << "inverse voxel size";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.info.pageWidth = a.info.pageHeight = 1u << 31;
        a.info.pageCount = 4; // the product is 2^64
    })) << "pages";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.triangles = std::vector<TriangleRecord>{a.triangles[0], a.triangles[0]};
    })) << "a triangle under another's number";
    const auto withMark = [](float mark) {
        return [=](Atlas& a) {
            std::vector<TriangleRecord> triangles(a.triangles.begin(), a.triangles.end());
            triangles[1].v1.w = mark;
            a.triangles = std::move(triangles);
        };
    };
    EXPECT_FALSE(refused(withMark(1.0f)));
    EXPECT_TRUE(refused(withMark(2.0f))) << "neither a sliver nor none";
    EXPECT_TRUE(refused(withMark(std::numeric_limits<float>::quiet_NaN()))) << "a mark that is no number";
    EXPECT_TRUE(refused([](Atlas& a) { a.grid.worldOffset.w = 0.3f; })) << "scale";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.triangleVertices = std::vector<glm::uvec4>(2, {0, 1, 4, 0});
    })) << "vertex";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.images = std::vector<ImagePlace>{{{1, 0, 2, 1}, {0, 0, 0, 0}}};
    })) << "image";
    EXPECT_TRUE(refused([](Atlas& a) {
        a.images = std::vector<ImagePlace>{{{0, 0, 2, 1}, {1, 0, 0, 0}}};
    })) << "page";
    EXPECT_FALSE(refused([](Atlas&) {}));
}

} // namespace
} // namespace rt::test
