// Order, transforms, instances and refusals, through files as users have them.
#include "common/error.h"
#include "tests/unit/import_files.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace rt {
namespace {

using test::gltfTriangle;
using test::ModelFiles;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<glm::vec3> cornersOf(const Mesh& mesh, std::size_t triangle) {
    const glm::uvec3 t = mesh.triangles[triangle];
    return {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
}

ErrorKind kindOf(const ModelFiles& files, const std::string& name, std::string& message) {
    try {
        files.import(name);
    } catch (const Error& error) {
        message = error.what();
        return error.kind();
    }
    message = "no error";
    return ErrorKind::Internal;
}

TEST(ImportGeometry, ObjFacesStandInFileOrderWhenMaterialsAndGroupsAlternate) {
    ModelFiles files;
    files.write("m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nnewmtl unused\nKd 0 0 1\n");
    files.write(
        "m.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n"
        "usemtl b\nf 1 2 3\nusemtl a\nf 1 3 4\ng other\nf 2 5 3\nusemtl b\nf 1 2 4\ng again\nf 5 3 2\n");
    const ImportedModel model = files.import("m.obj");
    ASSERT_EQ(model.mesh.triangles.size(), 5u);
    EXPECT_THAT(cornersOf(model.mesh, 1),
                ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)));
    EXPECT_THAT(cornersOf(model.mesh, 4),
                ElementsAre(glm::vec3(2, 0, 0), glm::vec3(1, 1, 0), glm::vec3(1, 0, 0)));
    EXPECT_THAT(model.mesh.triangleMaterial, ElementsAre(1, 0, 0, 1, 1));
    ASSERT_EQ(model.mesh.materials.size(), 2u); // the unused one is gone
    EXPECT_EQ(model.mesh.materials[0].baseColor, glm::vec4(1, 0, 0, 1));
}

TEST(ImportGeometry, ObjRunsOfAnObjectThatReturnsStandBehindItsEarlierOnes) {
    ModelFiles files;
    files.write("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nv 0 1 0\n"
                         "usemtl p\no A\nf 1 2 6\nusemtl q\no B\nf 2 3 6\n"
                         "o A\nf 3 4 6\nusemtl p\nf 4 5 6\n");
    const Mesh mesh = files.import("m.obj").mesh;
    std::vector<float> order;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) order.push_back(cornersOf(mesh, t)[0].x);
    EXPECT_THAT(order, ElementsAre(0, 3, 1, 2));
}

TEST(ImportGeometry, PolygonsAreCutInPlaceAndTheLedgerCountsThemOnce) {
    ModelFiles files;
    files.write("m.obj", "o thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n"
                         "f 2 1 5\nf 1 2 3 4\nf 1 1 2\nl 1 2\np 3\nf 4 3 5\n");
    const ImportedModel model = files.import("m.obj");
    ASSERT_EQ(model.mesh.triangles.size(), 4u);
    EXPECT_EQ(cornersOf(model.mesh, 0)[2], glm::vec3(0, 0, 1));
    EXPECT_EQ(cornersOf(model.mesh, 1)[0], glm::vec3(0, 0, 0));
    EXPECT_EQ(cornersOf(model.mesh, 3)[2], glm::vec3(0, 0, 1));
    EXPECT_THAT(model.report.ledger.lines(),
                ElementsAre("points and lines: 2 dropped (first: face 3, 4 of mesh 'thing')",
                            "faces without area: 1 dropped (first: face 2 of mesh 'thing')"));
}

TEST(ImportGeometry, PlyFacesStandInFileOrder) {
    ModelFiles files;
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 3 1 0\n4 0 1 2 3\n3 2 2 1\n3 1 3 2\n";
    files.write("m.ply", ply);
    const ImportedModel model = files.import("m.ply");
    const Mesh& mesh = model.mesh;
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_EQ(cornersOf(mesh, 0)[0], glm::vec3(0, 0, 1));
    EXPECT_THAT(cornersOf(mesh, 3), ElementsAre(glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)));
    EXPECT_THAT(model.report.ledger[Defect::NoArea].first, ElementsAre(FaceOrigin{0, 2}));
    EXPECT_EQ(mesh.materials[0].baseColor, glm::vec4(0.8f, 0.8f, 0.8f, 1.0f)); // the default grey
}

TEST(ImportGeometry, StlFacetNormalsDoNotHideSmoothness) {
    ModelFiles files; // two facets at a flat angle
    files.write("m.stl",
                "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                "endfacet\nfacet normal 0 0.1 0.99\nouter loop\nvertex 1 0 0\nvertex 1 1 -0.2\nvertex 0 1 0\n"
                "endloop\nendfacet\nendsolid s\n");
    const ImportedModel model = files.import("m.stl");
    EXPECT_EQ(model.mesh.positions.size(), 4u);
    EXPECT_EQ(model.report.generatedNormals, 6u);
}

TEST(ImportGeometry, MirroringNodeTurnsTheWindingAndNotTheNormal) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0,"scale":[-2,1,1]})"));
    const Mesh mesh = files.import("m.gltf").mesh;
    EXPECT_THAT(cornersOf(mesh, 0), ElementsAre(glm::vec3(0, 0, 0), glm::vec3(0, 1, 0), glm::vec3(-2, 0, 0)));
    for (const glm::vec3& normal : mesh.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

TEST(ImportGeometry, NormalsFollowTheInverseTranspose) {
    ModelFiles files;
    files.write("m.gltf",
                gltfTriangle(files, glm::normalize(glm::vec3(1, 1, 0)), R"({"mesh":0,"scale":[2,1,1]})"));
    const Mesh mesh = files.import("m.gltf").mesh;
    EXPECT_LT(glm::distance(mesh.normals[0], glm::normalize(glm::vec3(0.5f, 1, 0))), 1e-6f);
}

TEST(ImportGeometry, FlatteningNodeKeepsValidNormals) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0,"scale":[1,1,0]})"));
    EXPECT_EQ(files.import("m.gltf").mesh.normals[0], glm::vec3(0, 0, 1));
}

TEST(ImportGeometry, InstancesBecomeCopiesDepthFirst) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1},
                                       R"({"mesh":0,"translation":[1,0,0],"children":[1,3]},
                                          {"translation":[0,10,0],"children":[2]},
                                          {"mesh":0,"translation":[0,0,100]},
                                          {"mesh":0,"rotation":[0,0,1,0]})"));
    const Mesh mesh = files.import("m.gltf").mesh;
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(cornersOf(mesh, 0)[0], glm::vec3(1, 0, 0));
    EXPECT_EQ(cornersOf(mesh, 1)[0], glm::vec3(1, 10, 100));
    EXPECT_EQ(cornersOf(mesh, 2)[1], glm::vec3(0, 0, 0)); // turned by half a turn about z
}

TEST(ImportGeometry, FacesWithVerticesThatAreNotFiniteAreDropped) {
    ModelFiles files;
    files.write("m.obj", "o thing\nv 0 0 0\nv nan 0 0\nv 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 4 5\nf 1 2 3\n");
    const ImportedModel model = files.import("m.obj");
    EXPECT_EQ(model.mesh.triangles.size(), 1u);
    EXPECT_THAT(model.report.ledger.lines(),
                ElementsAre("faces with vertices that are not finite: 1 dropped (first: face 1 of mesh "
                            "'thing')"));
}

TEST(ImportGeometry, NothingButFacesThatAreNotFiniteIsRefused) {
    ModelFiles files;
    files.write("m.obj", "o thing\nv 0 0 0\nv nan 0 0\nv 0 inf 0\nf 1 2 3\n");
    std::string message;
    EXPECT_EQ(kindOf(files, "m.obj", message), ErrorKind::InvalidContent);
    EXPECT_THAT(message, HasSubstr("m.obj: has no triangles (faces with vertices that are not finite: 1 "));
}

TEST(ImportGeometry, PolygonsThatCrossThemselvesAreEntered) {
    ModelFiles files; // a polygon whose corners all lie on one line, and a sound triangle
    files.write("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 5\n");
    const ImportedModel model = files.import("m.obj");
    EXPECT_EQ(model.mesh.triangles.size(), 1u);
    const Ledger& ledger = model.report.ledger;
    EXPECT_EQ(ledger[Defect::NoArea].count + ledger[Defect::BadPolygons].count, 2u);
}

TEST(ImportGeometry, CoordinatesThatOverflowAreDroppedOrRefused) {
    ModelFiles files;
    files.write("far.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0,"scale":[1e30,1,1],"children":[1]},
                                                              {"mesh":0,"scale":[1e30,1,1]})"));
    files.write("wide.obj", "v -3e38 0 0\nv 3e38 0 0\nv 0 1 0\nf 1 2 3\n");
    const ImportedModel far = files.import("far.gltf");
    EXPECT_EQ(far.mesh.triangles.size(), 1u);
    EXPECT_EQ(far.report.ledger[Defect::NotFinite].count, 1u);
    std::string message;
    EXPECT_EQ(kindOf(files, "wide.obj", message), ErrorKind::InvalidContent);
    EXPECT_THAT(message, HasSubstr("overflows"));
}

TEST(ImportGeometry, NothingToSeeIsRefused) {
    ModelFiles files;
    files.write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n");
    std::string message;
    EXPECT_EQ(kindOf(files, "lines.obj", message), ErrorKind::InvalidContent);
    EXPECT_THAT(message, HasSubstr("has no triangles"));
}

} // namespace
} // namespace rt
