// The table of materials in tools/rt-import/README.md, the rules for texture paths, and which way up images
// are.
#include "common/error.h"
#include "tests/unit/import_files.h"
#include "tools/rt-import/files_asked.h"

#include <gmock/gmock.h>

#include <optional>
#include <unistd.h>

namespace rt {
namespace {

using test::fourColourImage;
using test::ModelFiles;
using test::rgbaImage;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kTexturedTriangle =
    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";

struct OpticsCase {
    const char* name;
    const char* text;
    glm::vec3 wanted; // reflectivity, transmission, index of refraction
};

void PrintTo(const OpticsCase& c, std::ostream* os) {
    *os << c.name;
}

void expectNear(const Material& material, const glm::vec3& wanted) {
    const float mirror = material.reflection.w;
    const glm::vec3 found(mirror, (1.0f - mirror) * material.transmission.x, material.transmission.y);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-6f) << "component " << i;
}

class MtlOptics : public testing::TestWithParam<OpticsCase> {};

TEST_P(MtlOptics, FollowTheTable) {
    ModelFiles files;
    files.write("m.mtl", std::string("newmtl m\nKs 0.1 0.5 0.2\n") + GetParam().text);
    files.write("m.obj", kTexturedTriangle);
    expectNear(files.import("m.obj").mesh.materials[0], GetParam().wanted);
}

INSTANTIATE_TEST_SUITE_P(
    Import, MtlOptics,
    testing::Values(OpticsCase{"HighlightIsNoMirror", "illum 2\n", {0, 0, 1}},
                    OpticsCase{"Illum3Mirrors", "illum 3\n", {0.5f, 0, 1}},
                    OpticsCase{"Illum8Mirrors", "illum 8\n", {0.5f, 0, 1}},
                    OpticsCase{"DissolveTransmits", "illum 2\nd 0.25\nNi 1.3\n", {0, 0.75f, 1.3f}},
                    OpticsCase{"TrTransmits", "Tr 0.25\n", {0, 0.25f, 1}},
                    OpticsCase{"GlassWithoutNi", "illum 7\nd 0.75\n", {0.5f, 0.25f, 1.5f}},
                    OpticsCase{"GlassIsClearFirst", "illum 7\nd 0.25\nNi 1.5\n", {0.25f, 0.75f, 1.5f}},
                    OpticsCase{"NiBelowOne", "d 0.5\nNi 0.5\n", {0, 0.5f, 1}},
                    OpticsCase{"AbsurdNumbers", "illum 3\nKs 7 0 0\nd -3\nNi 1e9\n", {0, 1, 100}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ImportMaterials, ColoursAndEmissionAreTakenAsTheyAre) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nKd 0.25 0.5 0.75\nKe 36 33 24\n");
    files.write("m.obj", kTexturedTriangle);
    const Mesh mesh = files.import("m.obj").mesh;
    EXPECT_EQ(mesh.materials[0].baseColor, glm::vec4(0.25f, 0.5f, 0.75f, 1));
    EXPECT_EQ(mesh.materials[0].emission, glm::vec4(36, 33, 24, 0));
    EXPECT_THAT(mesh.texcoords, IsEmpty()); // no image, no need of them
}

TEST(ImportMaterials, ObjImageStandsUpright) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nmap_Kd -clamp on four.ppm\n");
    files.write("m.obj", kTexturedTriangle);
    files.write("four.ppm", fourColourImage());
    const ImportedModel model = files.import("m.obj");
    const Mesh& mesh = model.mesh;
    EXPECT_THAT(model.report.warnings, IsEmpty());
    ASSERT_EQ(mesh.images.size(), 1u);
    EXPECT_EQ(mesh.images[0].wrapU, kWrapClamp);
    // Top row first, R in the lowest byte; v = 0, where OBJ has the bottom, stays 0.
    EXPECT_THAT(mesh.pixels, ElementsAre(0xff0000ffu, 0xff00ff00u, 0xffff0000u, 0xffffffffu));
    EXPECT_THAT(mesh.texcoords, ElementsAre(glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)));
}

TEST(ImportMaterials, GltfImageStandsUpright) {
    ModelFiles files;
    // The attribute that the triangle calls NORMAL serves as texture coordinates (0, 0) here: glTF's top
    // left.
    std::string text = test::gltfTriangle(
        files, {0, 0, 1}, R"({"mesh":0})", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})",
        R"(,"textures":[{"source":0,"sampler":0}],"images":[{"uri":"four.ppm"}],
                                        "samplers":[{"wrapS":33648,"wrapT":33071}])");
    text.replace(text.find("\"NORMAL\":1"), 10, "\"TEXCOORD_0\":2");
    text.insert(text.find("\"type\":\"VEC3\"}]") + 14,
                R"(,{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"})");
    files.write("m.gltf", text);
    files.write("four.ppm", fourColourImage());
    const Mesh mesh = files.import("m.gltf").mesh;
    ASSERT_EQ(mesh.images.size(), 1u);
    EXPECT_EQ(mesh.images[0].wrapU, kWrapMirror);
    EXPECT_EQ(mesh.images[0].wrapV, kWrapClamp);
    EXPECT_EQ(mesh.pixels[0], 0xff0000ffu);
    EXPECT_EQ(mesh.texcoords[mesh.triangles[0].x], glm::vec2(0, 1)); // the top edge of ours
}

TEST(ImportMaterials, OneImageForEachFileAndWrapAndPixelsOnlyOnce) {
    ModelFiles files;
    files.write(
        "m.mtl",
        "newmtl a\nmap_Kd four.ppm\nnewmtl b\nmap_Kd -clamp on four.ppm\nnewmtl c\nmap_Kd ./four.ppm\n"
        "newmtl unused\nmap_Kd missing.png\n");
    files.write(
        "m.obj",
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 3/1\n"
        "usemtl c\nf 1/1 2/1 3/1\n");
    files.write("four.ppm", fourColourImage());
    const ImportedModel model = files.import("m.obj");
    EXPECT_THAT(model.report.warnings, IsEmpty());
    EXPECT_EQ(model.mesh.images.size(), 2u);
    EXPECT_EQ(model.mesh.pixels.size(), 4u);
    EXPECT_EQ(model.mesh.materials[0].images.x, model.mesh.materials[2].images.x);
    EXPECT_NE(model.mesh.materials[0].images.x, model.mesh.materials[1].images.x);
    EXPECT_THAT(FilesAsked({files.path("m.obj")}, {}).found(model.filesAsked),
                ElementsAre(EndsWith("four.ppm"), EndsWith("m.mtl")));
}

class TexturePath : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(TexturePath, IsFoundInTheModelsFolder) {
    const auto [named, stored] = GetParam();
    ModelFiles files;
    files.write("m.mtl", std::string("newmtl m\nmap_Kd ") + named + "\n");
    files.write("m.obj", kTexturedTriangle);
    files.write(stored, fourColourImage());
    const ImportedModel model = files.import("m.obj");
    EXPECT_THAT(model.report.warnings, IsEmpty());
    EXPECT_EQ(model.mesh.images.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    Import, TexturePath,
    testing::Values(std::pair{"tex\\four.ppm", "tex/four.ppm"}, std::pair{".\\four.ppm", "four.ppm"},
                    std::pair{"TEX/Four.PPM", "tex/four.ppm"}, std::pair{"C:\\art\\four.ppm", "four.ppm"},
                    std::pair{"/art/four.ppm", "four.ppm"}, std::pair{"../art/four.ppm", "four.ppm"},
                    std::pair{"my%20four.ppm", "my four.ppm"}));

TEST(ImportMaterials, NothingOutsideTheModelsFolderIsRead) {
    ModelFiles files;
    files.write("secret.mtl", "newmtl m\nKd 1 0 0\n");
    files.write("secret.ppm", fourColourImage());
    files.write("in/m.mtl", "newmtl m\nmap_Kd ../secret.ppm\n");
    files.write("in/m.obj", "mtllib ../secret.mtl\n" + kTexturedTriangle);
    const ImportedModel model = files.import("in/m.obj");
    EXPECT_THAT(model.mesh.images, IsEmpty());
    EXPECT_NE(model.mesh.materials[0].baseColor, glm::vec4(1, 0, 0, 1));
    EXPECT_THAT(FilesAsked({files.path("in/m.obj")}, {}).found(model.filesAsked),
                ElementsAre(EndsWith("in/m.mtl")));
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("secret.mtl"), HasSubstr("secret.ppm")));
}

TEST(ImportMaterials, MissingAndDamagedTexturesLeaveTheFactorAndAWarning) {
    ModelFiles files;
    files.write("m.obj", kTexturedTriangle);
    files.write("bad.png", "\x89PNG but no more");
    for (const char* name : {"gone.png", "bad.png"}) {
        files.write("m.mtl", std::string("newmtl m\nKd 0.5 0.25 1\nmap_Kd ") + name + "\n");
        const ImportedModel model = files.import("m.obj");
        EXPECT_EQ(model.mesh.materials[0].images.x, kNoImage);
        EXPECT_EQ(model.mesh.materials[0].baseColor, glm::vec4(0.5f, 0.25f, 1, 1));
        EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr(name)));
        EXPECT_THAT(model.mesh.texcoords, IsEmpty());
    }
}

TEST(ImportMaterials, ATextureThatMayNotBeReadIsAWarningToo) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nmap_Kd secret.ppm\n");
    files.write("m.obj", kTexturedTriangle);
    files.write("secret.ppm", fourColourImage());
    const std::filesystem::path folder = std::filesystem::path(files.path("m.obj")).parent_path();
    std::filesystem::permissions(folder, std::filesystem::perms(0755));
    std::filesystem::permissions(files.path("secret.ppm"), std::filesystem::perms::none);
    const bool root = geteuid() == 0; // whom permissions do not stop
    ASSERT_EQ(seteuid(root ? 65534 : geteuid()), 0);
    const auto import = [&] { return files.import("m.obj"); };
    std::optional<ImportedModel> model;
    EXPECT_NO_THROW(model = import());
    ASSERT_EQ(seteuid(root ? 0 : geteuid()), 0);
    ASSERT_TRUE(model);
    EXPECT_EQ(model->mesh.materials[0].images.x, kNoImage);
    EXPECT_THAT(model->report.warnings, ElementsAre(HasSubstr("cannot be opened: Permission denied")));
}

TEST(ImportMaterials, TooManyPixelsInAllHitTheLimitBeforeTheyAreDecoded) {
    ModelFiles files;
    files.write("m.mtl", "newmtl a\nmap_Kd small.ppm\nnewmtl b\nmap_Kd large.ppm\n");
    files.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n"
                         "usemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 3/1 2/1\n");
    files.write("small.ppm", fourColourImage());
    files.write("large.ppm", "P6\n16384 16384\n255\n");
    try {
        files.import("m.obj");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        EXPECT_THAT(error.what(), HasSubstr("large.ppm: with this image of 16384x16384 the textures exceed"));
    }
}

TEST(ImportMaterials, OversizedImageHitsTheLimitBeforeItIsDecoded) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nmap_Kd wide.ppm\n");
    files.write("m.obj", kTexturedTriangle);
    files.write("wide.ppm", "P6\n16385 1\n255\n");
    try {
        files.import("m.obj");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        EXPECT_THAT(error.what(), HasSubstr("wide.ppm: image of 16385x1 pixels exceeds 16384"));
    }
}

TEST(ImportMaterials, MtlReflectsByFresnelWhereIllumSaysSo) {
    for (const auto& [text, specular] : {std::pair("illum 2\nNs 90\n", 0.0f),
                                         {"illum 4\n", 0.0f},
                                         {"illum 5\n", 1.0f},
                                         {"illum 7\n", 1.0f}}) {
        ModelFiles files;
        files.write("m.mtl", std::string("newmtl m\nKs 0.5 0.5 0.5\n") + text);
        files.write("m.obj", kTexturedTriangle);
        const Material material = files.import("m.obj").mesh.materials[0];
        EXPECT_EQ(glm::vec3(material.reflection), glm::vec3(0, 1, specular)) << text;
        EXPECT_EQ(material.baseColor.a, 1.0f);
    }
}

TEST(ImportMaterials, MtlMetallicAndRoughnessAreTaken) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nPr 0.25\nPm 0.75\nmap_Pr a.tga\n");
    files.write("m.obj", kTexturedTriangle);
    const ImportedModel model = files.import("m.obj");
    EXPECT_EQ(glm::vec3(model.mesh.materials[0].reflection), glm::vec3(0.75f, 0.25f, 1));
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("roughness texture is not carried over")));
}

TEST(ImportMaterials, MtlOpacityMapBecomesTheAlphaOfTheBaseColour) {
    ModelFiles files;
    files.write("m.obj", kTexturedTriangle);
    files.write("color.tga", rgbaImage(2, 1, {0x80112233u, 0xFF445566u}));
    files.write("grey.tga", rgbaImage(2, 1, {0xFF404040u, 0xFFC0C0C0u}));
    files.write("large.tga", rgbaImage(4, 2, std::vector(8, 0x20FFFFFFu)));
    const auto pixelsOf = [&](const char* maps) {
        files.write("m.mtl", std::string("newmtl m\n") + maps);
        const ImportedModel model = files.import("m.obj");
        EXPECT_THAT(model.report.warnings, IsEmpty()) << maps;
        EXPECT_EQ(model.mesh.materials[0].images.x, 0u);
        return std::vector<std::uint32_t>(model.mesh.pixels.begin(), model.mesh.pixels.end());
    };
    EXPECT_THAT(pixelsOf("map_Kd color.tga\n"), ElementsAre(0xFF112233u, 0xFF445566u)); // not its own alpha
    EXPECT_THAT(pixelsOf("map_Kd color.tga\nmap_d color.tga\n"), ElementsAre(0x80112233u, 0xFF445566u));
    EXPECT_THAT(pixelsOf("map_Kd color.tga\nmap_d grey.tga\n"), ElementsAre(0x40112233u, 0xC0445566u));
    EXPECT_THAT(pixelsOf("map_Kd color.tga\nmap_d large.tga\n"), ElementsAre(0x20112233u, 0x20445566u));
    EXPECT_THAT(pixelsOf("map_d grey.tga\n"), ElementsAre(0x40FFFFFFu, 0xC0FFFFFFu));
}

TEST(ImportMaterials, AMissingOpacityMapIsNamedAndLeavesTheColours) {
    ModelFiles files;
    files.write("m.mtl", "newmtl m\nmap_Kd color.tga\nmap_d ../gone.tga\n");
    files.write("m.obj", kTexturedTriangle);
    files.write("color.tga", rgbaImage(1, 1, {0x80112233u}));
    const ImportedModel model = files.import("m.obj");
    EXPECT_THAT(model.mesh.pixels, ElementsAre(0xFF112233u));
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("gone.tga")));
}

TEST(ImportMaterials, ABumpMapCountsOnlyIfItHoldsNormals) {
    ModelFiles files;
    files.write("m.obj", kTexturedTriangle);
    files.write("heights.tga", rgbaImage(2, 1, {0xFF404040u, 0xFFC0C0C0u}));
    files.write("normals.tga", rgbaImage(2, 1, {0xFFFF8080u, 0xFFF09060u}));
    files.write("m.mtl", "newmtl m\nmap_bump -bm 0.5 heights.tga\n");
    const ImportedModel heights = files.import("m.obj");
    EXPECT_EQ(heights.mesh.materials[0].images.z, kNoImage);
    EXPECT_THAT(heights.report.warnings, ElementsAre(HasSubstr("holds heights")));
    for (const char* key : {"map_bump -bm 0.5", "norm -bm 0.5"}) {
        files.write("m.mtl", std::string("newmtl m\n") + key + " normals.tga\n");
        const ImportedModel normals = files.import("m.obj");
        EXPECT_THAT(normals.report.warnings, IsEmpty());
        ASSERT_EQ(normals.mesh.materials[0].images.z, 0u);
        EXPECT_EQ(normals.mesh.materials[0].attenuation.w, 0.5f);
        EXPECT_EQ(normals.mesh.images[0].space, kImageLinear);
    }
}

} // namespace
} // namespace rt
