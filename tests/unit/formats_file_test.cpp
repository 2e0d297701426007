// .rtmesh and .rtatlas: what is written comes back, and a file that was damaged anywhere is refused.
#include "common/error.h"
#include "formats/atlas_file.h"
#include "formats/mesh_file.h"
#include "formats/section_file.h"
#include "tests/support/read_text.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <bit>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <sys/stat.h>
#include <thread>

namespace rt {
namespace {

Material greyMaterial(std::uint32_t image) {
    Material material = diffuseMaterial(glm::vec3(0.5f));
    material.reflection.w = 0.25f;
    material.transmission = glm::vec4(0.5f, 1.5f, 0.0f, 0.0f);
    material.images.x = image;
    return material;
}

CameraKey keyAt(std::uint32_t camera, double frame) {
    CameraKey key;
    key.frame = frame;
    key.eye = {frame, 0, 4};
    key.fovDegrees = 30.0;
    key.camera = camera;
    return key;
}

// Two cameras, of which one moves, and an environment of two pixels, for a Mesh or an Atlas.
template <class Scene>
void addScenery(Scene& scene) {
    NamedCamera camera{"a", {0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 30.0, 0, 0, 0, kCameraPerspective, 0};
    NamedCamera round = camera;
    round.name[0] = 'b';
    round.kind = kCameraPanorama;
    scene.cameras = std::vector<NamedCamera>{camera, round};
    scene.cameraKeys = std::vector<CameraKey>{keyAt(0, 1), keyAt(0, 2.5), keyAt(1, -1)};
    scene.surroundings = std::vector<Surroundings>{{{1, 2, 3}, 1, 0.5f, 90.0f, 2, 1}};
    scene.environment = std::vector<glm::vec3>{{0, 0, 0}, {1, 2, 1000}};
}

// What can be wrong with that, each with what it is.
template <class Scene>
std::vector<std::pair<const char*, std::function<void(Scene&)>>> wrongScenery() {
    const auto keys = [](std::vector<CameraKey> wrong) {
        return [=](Scene& s) { s.cameraKeys = std::vector<CameraKey>(wrong); };
    };
    const auto around = [](Surroundings wrong) {
        return [=](Scene& s) { s.surroundings = std::vector<Surroundings>{wrong}; };
    };
    const float inf = std::numeric_limits<float>::infinity();
    CameraKey flat = keyAt(0, 1), lost = keyAt(0, 1);
    flat.fovDegrees = 180.0;
    lost.eye.x = double(inf);
    return {{"frames are not in order", keys({keyAt(0, 2), keyAt(0, 1)})},
            {"a frame twice", keys({keyAt(0, 1), keyAt(0, 1)})},
            {"cameras are not in order", keys({keyAt(1, 1), keyAt(0, 2)})},
            {"no such camera", keys({keyAt(2, 1)})},
            {"no view", keys({flat})},
            {"nowhere", keys({lost})},
            {"pixels are missing", around({{0, 0, 0}, 0, 1, 0, 2, 2})},
            {"pixels are too many", around({{0, 0, 0}, 0, 1, 0, 0, 0})},
            {"a side of 0", around({{0, 0, 0}, 0, 1, 0, 2, 0})},
            {"a negative background", around({{-1, 0, 0}, 1, 1, 0, 2, 1})},
            {"neither stated nor not", around({{0, 0, 0}, 2, 1, 0, 2, 1})},
            {"an infinite strength", around({{0, 0, 0}, 0, inf, 0, 2, 1})},
            {"a negative strength", around({{0, 0, 0}, 0, -1, 0, 2, 1})},
            {"an infinite turn", around({{0, 0, 0}, 0, 1, inf, 2, 1})},
            {"pixels without a size", [](Scene& s) { s.surroundings = {}; }},
            {"two surroundings",
             [](Scene& s) { s.surroundings = std::vector<Surroundings>(2, s.surroundings[0]); }},
            {"darkness", [](Scene& s) {
                 s.environment = std::vector<glm::vec3>{{0, 0, 0}, {0, -1, 0}};
             }}};
}

Mesh smallMesh() {
    Mesh mesh;
    mesh.positions = std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}};
    mesh.normals = std::vector<glm::vec3>(4, glm::vec3(0, 0, 1));
    mesh.texcoords = std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    mesh.triangles = std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}};
    mesh.triangleMaterial = std::vector<std::uint32_t>{0, 0};
    mesh.materials = std::vector<Material>{greyMaterial(0)};
    mesh.lights = std::vector<Light>{pointLight({1, 2, 3}, {4, 5, 6})};
    mesh.images = std::vector<MeshImage>{{2, 1, kWrapRepeat, kWrapClamp, 0, kImageSrgb, 0}};
    mesh.pixels = std::vector<std::uint32_t>{0xFF0000FFu, 0xFF00FF00u};
    return mesh;
}

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

template <class T>
std::string bytes(const SharedSpan<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void spill(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

ErrorKind failureOf(const std::function<void()>& read) {
    try {
        read();
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::Internal; // it was accepted
}

void expectEveryDamageIsRefused(const std::string& path, const std::function<void()>& read) {
    const std::string good = test::readText(path);
    ASSERT_GT(good.size(), 500u);
    for (std::size_t length = 0; length < good.size(); ++length) {
        spill(path, good.substr(0, length));
        ASSERT_EQ(failureOf(read), ErrorKind::InvalidContent) << "cut to " << length << " bytes";
    }
    spill(path, good + '\0');
    EXPECT_EQ(failureOf(read), ErrorKind::InvalidContent) << "one byte more";
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
        spill(path, bad);
        ASSERT_EQ(failureOf(read), ErrorKind::InvalidContent) << "byte " << i;
    }
    spill(path, good);
    EXPECT_NO_THROW(read());
}

TEST(MeshFile, ComesBackAsItWasWritten) {
    const test::TemporaryFolder folder;
    Mesh mesh = smallMesh();
    addScenery(mesh);
    writeMesh(folder.file("a.rtmesh"), mesh);
    const Mesh back = readMesh(folder.file("a.rtmesh")).mesh;
    EXPECT_EQ(bytes(back.positions), bytes(mesh.positions));
    EXPECT_EQ(bytes(back.normals), bytes(mesh.normals));
    EXPECT_EQ(bytes(back.texcoords), bytes(mesh.texcoords));
    EXPECT_EQ(bytes(back.triangles), bytes(mesh.triangles));
    EXPECT_EQ(bytes(back.triangleMaterial), bytes(mesh.triangleMaterial));
    EXPECT_EQ(bytes(back.materials), bytes(mesh.materials));
    EXPECT_EQ(bytes(back.lights), bytes(mesh.lights));
    EXPECT_EQ(bytes(back.images), bytes(mesh.images));
    EXPECT_EQ(bytes(back.pixels), bytes(mesh.pixels));
    EXPECT_EQ(bytes(back.cameras), bytes(mesh.cameras));
    EXPECT_EQ(bytes(back.cameraKeys), bytes(mesh.cameraKeys));
    EXPECT_EQ(bytes(back.surroundings), bytes(mesh.surroundings));
    EXPECT_EQ(bytes(back.environment), bytes(mesh.environment));
}

TEST(MeshFile, EveryDamageIsRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("a.rtmesh");
    writeMesh(path, smallMesh());
    expectEveryDamageIsRefused(path, [&] { readMesh(path); });
}

TEST(MeshFile, InvalidContentWithRightChecksumsIsRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("a.rtmesh");
    const auto refused = [&](const std::function<void(Mesh&)>& spoil) {
        Mesh mesh = smallMesh();
        spoil(mesh);
        writeMesh(path, mesh);
        return failureOf([&] { readMesh(path); }) == ErrorKind::InvalidContent;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refused([](Mesh& m) { m.triangles = std::vector<glm::uvec3>{{0, 1, 4}, {0, 1, 2}}; }));
    EXPECT_TRUE(refused([](Mesh& m) { m.triangles = {}; }));
    EXPECT_TRUE(refused([](Mesh& m) { m.triangleMaterial = std::vector<std::uint32_t>{0, 1}; }));
    EXPECT_TRUE(refused([](Mesh& m) { m.normals = std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)); }));
    EXPECT_TRUE(refused([](Mesh& m) { m.normals = std::vector<glm::vec3>(4, glm::vec3(0)); }));
    EXPECT_TRUE(refused([=](Mesh& m) { m.positions = std::vector<glm::vec3>(4, glm::vec3(nan)); }));
    EXPECT_TRUE(refused([](Mesh& m) { m.materials = std::vector<Material>{greyMaterial(1)}; }));
    EXPECT_TRUE(refused([](Mesh& m) { m.images = std::vector<MeshImage>{{2, 2, 0, 0, 0}}; }));
    EXPECT_TRUE(refused([](Mesh& m) { m.images = std::vector<MeshImage>{{2, 1, 0, 0, ~0ull}}; }));
    EXPECT_FALSE(refused([](Mesh&) {}));
    EXPECT_FALSE(refused([](Mesh& m) { addScenery(m); }));
    for (const auto& [what, spoil] : wrongScenery<Mesh>())
        EXPECT_TRUE(refused([&, s = spoil](Mesh& m) {
            addScenery(m);
            s(m);
        })) << what;
}

TEST(AtlasFile, ComesBackAsItWasWritten) {
    const test::TemporaryFolder folder;
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
    const test::TemporaryFolder folder;
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
    const test::TemporaryFolder folder;
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
    const test::TemporaryFolder folder;
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
    const test::TemporaryFolder folder;
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

TEST(SectionFile, UnknownSectionsAreSkippedAndOtherMajorVersionsRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("x");
    constexpr FileKind kind{{'\x89', 'T', 'E', 'S', 'T', ' ', ' ', '\n'}, 1, 5, ".test"};
    const std::vector<std::uint32_t> values{1, 2, 3};
    SectionFileWriter writer(kind);
    writer.add<std::uint32_t>(sectionId("NEWX"), values);
    writer.add<std::uint32_t>(sectionId("KNWN"), values);
    writer.write(path);
    FileKind reader = kind;
    reader.minor = 0;
    const SectionFile file(path, reader);
    EXPECT_EQ(file.get<std::uint32_t>(sectionId("KNWN"), 3)[2], 3u);
    EXPECT_TRUE(file.get<std::uint32_t>(sectionId("NONE")).empty());
    EXPECT_EQ(failureOf([&] { file.get<std::uint64_t>(sectionId("KNWN")); }), ErrorKind::InvalidContent);
    reader.major = 2;
    EXPECT_EQ(failureOf([&] { SectionFile(path, reader); }), ErrorKind::InvalidContent);
}

// A pipe into which a file's bytes go, and then as many zeros as the reader takes.
class EndlessPipe {
public:
    EndlessPipe(const std::string& path, const std::string& start) {
        EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
        writer_ = std::thread([path, start] {
            std::ofstream pipe(path, std::ios::binary);
            pipe << start;
            const std::string zeros(1u << 16, '\0');
            while (pipe << zeros) {
            }
        });
    }
    ~EndlessPipe() { writer_.join(); }

private:
    std::thread writer_;
};

TEST(SectionFile, StreamsWithoutAnEndAreRefusedWithoutReadingThem) {
    std::signal(SIGPIPE, SIG_IGN);
    const test::TemporaryFolder folder;
    EXPECT_EQ(failureOf([&] { readMesh("/dev/zero"); }), ErrorKind::InvalidContent);
    EXPECT_EQ(failureOf([&] { readAtlas("/dev/zero"); }), ErrorKind::InvalidContent);
    writeMesh(folder.file("a"), smallMesh());
    std::string whole = test::readText(folder.file("a"));
    {
        const EndlessPipe pipe(folder.file("longer"), whole);
        EXPECT_EQ(failureOf([&] { readMesh(folder.file("longer")); }), ErrorKind::InvalidContent);
    }
    const std::uint64_t huge = std::uint64_t(1) << 60;
    std::memcpy(whole.data() + offsetof(FileHeader, fileBytes), &huge, sizeof huge);
    const EndlessPipe pipe(folder.file("huge"), whole);
    EXPECT_EQ(failureOf([&] { readMesh(folder.file("huge")); }), ErrorKind::LimitExceeded);
}

} // namespace
} // namespace rt
