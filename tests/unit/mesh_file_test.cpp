// .rtmesh: what is written comes back, and a file that was damaged anywhere is refused.
#include "formats/mesh_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/format_files.h"

#include <gtest/gtest.h>

namespace rt::test {
namespace {

TEST(MeshFile, ComesBackAsItWasWritten) {
    const TemporaryFolder folder;
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
    const TemporaryFolder folder;
    const std::string path = folder.file("a.rtmesh");
    writeMesh(path, smallMesh());
    expectEveryDamageIsRefused(path, [&] { readMesh(path); });
}

TEST(MeshFile, InvalidContentWithRightChecksumsIsRefused) {
    const TemporaryFolder folder;
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

} // namespace
} // namespace rt::test
