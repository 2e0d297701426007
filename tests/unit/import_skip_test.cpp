// What nothing needs is left out and counted; what is lost is told.
#include "common/error.h"
#include "tests/unit/import_files.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rt {
namespace {

using test::ModelFiles;
using testing::ElementsAre;
using testing::HasSubstr;

LeftOut find(const ImportedModel& model, std::string_view what) {
    const auto& all = model.report.leftOut;
    const auto found = std::ranges::find_if(all, [&](const LeftOut& kind) { return kind.what == what; });
    EXPECT_NE(found, all.end()) << what;
    return found == all.end() ? LeftOut{} : *found;
}

// Two triangles side by side, of the materials named.
std::string twoTriangles(const std::string& first, const std::string& second) {
    return "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
           "usemtl " +
           first + "\nf 1/1 2/2 3/3\nusemtl " + second + "\nf 2/2 4/4 3/3\n";
}

TEST(ImportSkip, UnusedMaterialsVerticesAndTexcoords) {
    ModelFiles files;
    files.write("m.mtl",
                "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nnewmtl unused\nKd 0 0 1\nmap_Kd none.ppm\n");
    files.write("m.obj", twoTriangles("a", "b") + "f 2/2 2/2 3/3\n");
    const ImportedModel model = files.import("m.obj");
    EXPECT_EQ(find(model, "unusedMaterials").count, 1u);
    EXPECT_EQ(find(model, "unusedMaterials").bytes, sizeof(Material));
    EXPECT_EQ(find(model, "unusedTexcoords").count, 2u); // one set for each mesh
    EXPECT_EQ(find(model, "unusedTexcoords").bytes, 9 * sizeof(glm::vec2));
    EXPECT_EQ(find(model, "unusedVertices").count, 3u); // those of the face without area
    EXPECT_TRUE(model.mesh.texcoords.empty());
    EXPECT_EQ(byteCount(model.report.leftOut),
              sizeof(Material) + 9 * sizeof(glm::vec2) + 3 * sizeof(glm::vec3));
    EXPECT_THAT(model.report.warnings, testing::IsEmpty()); // the unused texture is not looked for
}

TEST(ImportSkip, EqualImagesAreKeptOnce) {
    ModelFiles files;
    files.write("one.ppm", test::fourColourImage());
    files.write("two.ppm", test::fourColourImage());
    files.write("other.ppm", std::string("P6\n2 2\n255\n\0\0\0\0\0\0\0\0\0\0\0\0", 23));
    files.write("m.mtl", "newmtl a\nmap_Kd one.ppm\nnewmtl b\nmap_Kd two.ppm\nmap_Ke other.ppm\nKe 1 1 1\n");
    files.write("m.obj", twoTriangles("a", "b"));
    const ImportedModel model = files.import("m.obj");
    ASSERT_EQ(model.mesh.images.size(), 2u);
    EXPECT_EQ(model.mesh.pixels.size(), 8u);
    EXPECT_EQ(model.mesh.materials[0].images.x, model.mesh.materials[1].images.x);
    EXPECT_NE(model.mesh.materials[1].images.x, model.mesh.materials[1].images.w);
    EXPECT_EQ(find(model, "unusedImages").count, 1u);
    EXPECT_EQ(find(model, "unusedImages").bytes, 16u);
}

TEST(ImportSkip, ImagesOfMaterialsThatLoseTheirTrianglesGo) {
    ModelFiles files;
    files.write("one.ppm", test::fourColourImage());
    files.write("m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd one.ppm\n");
    files.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n"
                         "usemtl b\nf 1/1 1/1 3/1\n");
    const ImportedModel model = files.import("m.obj");
    EXPECT_EQ(model.mesh.materials.size(), 1u);
    EXPECT_EQ(model.mesh.images.size(), 0u);
    EXPECT_EQ(model.mesh.pixels.size(), 0u);
    EXPECT_EQ(find(model, "unusedMaterials").count, 1u);
}

TEST(ImportSkip, ThousandsOfRepeatsAreOneWarning) {
    ModelFiles files;
    std::string library, obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
    for (const char* name : {"a", "b"}) library += std::string("newmtl ") + name + "\nmap_Kd no.ppm\n";
    files.write("m.mtl", library);
    files.write("m.obj", obj + "usemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 3/1 2/1\n");
    EXPECT_EQ(files.import("m.obj").report.warnings.size(), 2u); // they name their materials
    files.write("c.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                         "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
    EXPECT_THAT(files.import("c.ply").report.warnings,
                ElementsAre("1 meshes have colours at their vertices, which are not carried over"));
}

TEST(ImportSkip, InvisibleTrianglesGoUnlessNothingElseIsThere) {
    ModelFiles files;
    const std::string clear = R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0]}})";
    const auto gltf = [&](const std::string& second) {
        std::string text = test::gltfTriangle(files, {0, 0, 1}, R"({"mesh":0})", clear + "," + second);
        const std::string one = R"({"attributes":{"POSITION":0,"NORMAL":1},"material":0})";
        const std::size_t at = text.find(one);
        return text.replace(at, one.size(), one + R"(,{"attributes":{"POSITION":0},"material":1})");
    };
    files.write("m.gltf", gltf("{}"));
    const ImportedModel model = files.import("m.gltf");
    EXPECT_EQ(model.mesh.triangles.size(), 1u);
    EXPECT_EQ(model.mesh.materials.size(), 1u);
    EXPECT_EQ(find(model, "invisibleTriangles").count, 1u);
    files.write("all.gltf", gltf(clear));
    EXPECT_EQ(files.import("all.gltf").mesh.triangles.size(), 2u);
}

TEST(ImportSkip, StrictRefusesRepairsAndLosses) {
    ModelFiles files;
    files.write("sound.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    files.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n");
    files.write("lost.obj", "mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const ImportSettings strict{.strict = true};
    EXPECT_EQ(files.import("sound.obj", strict).mesh.triangles.size(), 1u);
    for (const auto& [name, reason] :
         {std::pair("flat.obj", "faces without area: 1 dropped"), {"lost.obj", "file 'no.mtl'"}})
        try {
            files.import(name, strict);
            FAIL() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::InvalidContent);
            EXPECT_THAT(error.what(), HasSubstr(reason));
            EXPECT_THAT(error.what(), HasSubstr("--strict"));
        }
}

} // namespace
} // namespace rt
