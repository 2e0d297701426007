// glTF's column of the table of materials in tools/rt-import/README.md.
#include "tests/support/scenes.h"
#include "tests/unit/import_files.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace rt {
namespace {

using test::gltfTriangle;
using test::ModelFiles;
using test::rgbaImage;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kExtensions =
    R"(,"extensionsUsed":["KHR_materials_transmission","KHR_materials_ior","KHR_materials_volume",
        "KHR_materials_unlit","KHR_texture_transform"],
        "textures":[{"source":0},{"source":1}],"images":[{"uri":"a.tga"},{"uri":"b.tga"}])";

const std::vector<std::uint32_t> kClearPixels{0x80112233u, 0xFF445566u};

// Two images of two pixels, a.tga with alpha and b.tga without, and a triangle of this material.
ImportedModel importMaterial(const std::string& material) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0})", material, kExtensions));
    files.write("a.tga", rgbaImage(2, 1, kClearPixels));
    files.write("b.tga", rgbaImage(2, 1, {0xFF808080u, 0xFF404040u}));
    return files.import("m.gltf");
}

Material materialOf(const std::string& material) {
    const ImportedModel model = importMaterial(material);
    EXPECT_THAT(model.report.warnings, IsEmpty());
    return model.mesh.materials[0];
}

TEST(ImportGltf, MetalAndRoughness) {
    const Material m = materialOf(R"({"pbrMetallicRoughness":{"metallicFactor":0.75,"roughnessFactor":0.25,
                                     "baseColorFactor":[0.5,0.25,1,0.5]}})");
    EXPECT_EQ(m.baseColor, glm::vec4(0.5f, 0.25f, 1, 1)); // opaque: alpha does not count
    EXPECT_EQ(m.reflection, glm::vec4(0.75f, 0.25f, 1, 0));
    EXPECT_EQ(m.transmission, glm::vec4(0, 1.5f, 0, 0));
    EXPECT_EQ(m.images, glm::uvec4(kNoImage));
    const Material byDefault = materialOf("{}");
    EXPECT_EQ(byDefault.reflection, glm::vec4(1, 1, 1, 0));
}

TEST(ImportGltf, AlphaModes) {
    const std::string rest = R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25],
                                "baseColorTexture":{"index":0}}})";
    const auto opacity = [&](const std::string& mode, std::uint32_t firstPixel) {
        const Mesh mesh = importMaterial("{" + mode + rest).mesh;
        EXPECT_EQ(mesh.pixels[0], firstPixel) << mode;
        EXPECT_EQ(mesh.materials[0].transmission.x, 0.0f);
        return glm::vec2(mesh.materials[0].baseColor.a, mesh.materials[0].transmission.w);
    };
    EXPECT_EQ(opacity("", 0xFF112233u), glm::vec2(1, 0));
    EXPECT_EQ(opacity(R"("alphaMode":"BLEND",)", 0x80112233u), glm::vec2(0.25f, 0));
    EXPECT_EQ(opacity(R"("alphaMode":"MASK","alphaCutoff":0.2,)", 0x80112233u), glm::vec2(0.25f, 0.2f));
    EXPECT_EQ(opacity(R"("alphaMode":"MASK",)", 0x80112233u), glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(opacity(R"("alphaMode":"MASK","alphaCutoff":0,)", 0xFF112233u), glm::vec2(1, 0));
}

TEST(ImportGltf, EveryTextureHasItsPlaceAndColourSpace) {
    const ImportedModel model = importMaterial(
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":1}},
            "normalTexture":{"index":1,"scale":0.5},"emissiveTexture":{"index":0},"emissiveFactor":[1,0.5,0],
            "occlusionTexture":{"index":1},
            "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":1}}}})");
    const Mesh& mesh = model.mesh;
    EXPECT_THAT(model.report.warnings, IsEmpty());
    ASSERT_EQ(mesh.images.size(), 2u); // each is used in one space
    EXPECT_EQ(mesh.images[0].space, kImageSrgb);
    EXPECT_EQ(mesh.images[1].space, kImageLinear);
    const Material& m = mesh.materials[0];
    EXPECT_EQ(m.images, glm::uvec4(0, 1, 1, 0));
    EXPECT_EQ(m.more, glm::uvec4(1, kMaterialThin, 0, 0));
    EXPECT_EQ(m.emission, glm::vec4(1, 0.5f, 0, 0));
    EXPECT_EQ(m.attenuation.w, 0.5f);
}

TEST(ImportGltf, OneFileInTwoSpacesIsTwoImagesOfTheSamePixels) {
    const Mesh mesh = importMaterial(R"({"emissiveTexture":{"index":1},"emissiveFactor":[1,1,1],
                                         "normalTexture":{"index":1}})")
                          .mesh;
    ASSERT_EQ(mesh.images.size(), 2u);
    EXPECT_NE(mesh.images[0].space, mesh.images[1].space);
    EXPECT_EQ(mesh.pixels.size(), 2u);
}

TEST(ImportGltf, TransmissionVolumeAndIndexOfRefraction) {
    const auto glass = [](const std::string& volume) {
        return materialOf(R"({"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{)" + volume +
                          R"("KHR_materials_transmission":{"transmissionFactor":0.9},
                             "KHR_materials_ior":{"ior":1.33}}})");
    };
    const Material thin = glass("");
    EXPECT_EQ(thin.transmission, glm::vec4(0.9f, 1.33f, 0, 0));
    EXPECT_EQ(thin.more.y, kMaterialThin);
    EXPECT_EQ(glass(R"("KHR_materials_volume":{"thicknessFactor":0},)").more.y, kMaterialThin);
    const Material solid = glass(R"("KHR_materials_volume":{"thicknessFactor":0.1,"attenuationDistance":2,
                                    "attenuationColor":[0.1,0.2,0.3]},)");
    EXPECT_EQ(solid.transmission, glm::vec4(0.9f, 1.33f, 2, 0));
    EXPECT_EQ(solid.attenuation, glm::vec4(0.1f, 0.2f, 0.3f, 1));
    EXPECT_EQ(solid.more.y, 0u);
    EXPECT_EQ(glass(R"("KHR_materials_volume":{"thicknessFactor":0.1},)").transmission.z, 0.0f); // clear
}

TEST(ImportGltf, UnlitIsBaseColourAlone) {
    const Material m = materialOf(
        R"({"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},
            "emissiveTexture":{"index":1},"emissiveFactor":[1,1,1]})");
    EXPECT_EQ(m.more.y, kMaterialUnlit);
    EXPECT_EQ(m.images, glm::uvec4(0, kNoImage, kNoImage, kNoImage));
    EXPECT_EQ(m.emission, glm::vec4(0));
    EXPECT_EQ(m.reflection.x, 0.0f);
}

TEST(ImportGltf, EmissiveStrengthAndSpecularAreReadWhereAssimpDoesNot) {
    const Material m = materialOf(R"({"emissiveFactor":[1,0.5,0],"extensions":{
        "KHR_materials_emissive_strength":{"emissiveStrength":8},
        "KHR_materials_specular":{"specularFactor":0.25}}})");
    EXPECT_EQ(m.emission, glm::vec4(8, 4, 0, 0));
    EXPECT_EQ(m.reflection.z, 0.25f);
    const ImportedModel coloured =
        importMaterial(R"({"extensions":{"KHR_materials_specular":{"specularColorFactor":[1,0,0]}}})");
    EXPECT_THAT(coloured.report.warnings, ElementsAre(HasSubstr("specular colour is not carried over")));
}

// Assimp numbers materials by its order of reading, here 2, 0.
TEST(ImportGltf, ExtrasFindTheirMaterialWhateverItsNumber) {
    ModelFiles files;
    const auto glow = [](int strength) {
        return R"({"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":)" +
               std::to_string(strength) + "}}}";
    };
    std::string text =
        gltfTriangle(files, {0, 0, 1}, R"({"mesh":0})", glow(2) + "," + glow(3) + "," + glow(4));
    const std::string primitive = R"({"attributes":{"POSITION":0,"NORMAL":1},"material":0})";
    text.replace(text.find(primitive), primitive.size(),
                 R"({"attributes":{"POSITION":0},"material":2},{"attributes":{"POSITION":0},"material":0})");
    files.write("m.gltf", text);
    const Mesh mesh = files.import("m.gltf").mesh;
    EXPECT_EQ(mesh.materials[mesh.triangleMaterial[0]].emission.x, 4.0f);
    EXPECT_EQ(mesh.materials[mesh.triangleMaterial[1]].emission.x, 2.0f);
}

TEST(ImportGltf, ExtensionsThatAreNotReadAreNamed) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0})", "{}",
                                       R"(,"extensionsUsed":["KHR_materials_iridescence"])"));
    EXPECT_THAT(files.import("m.gltf").report.warnings, ElementsAre(HasSubstr("KHR_materials_iridescence")));
}

TEST(ImportGltf, ATextureWithOtherCoordinatesIsNamedAndItsFactorsStandAlone) {
    const ImportedModel model = importMaterial(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},
                           "metallicRoughnessTexture":{"index":1,"texCoord":1}}})");
    EXPECT_EQ(model.mesh.materials[0].images, glm::uvec4(0, kNoImage, kNoImage, kNoImage));
    EXPECT_EQ(model.mesh.materials[0].reflection, glm::vec4(1, 1, 1, 0));
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("its roughness texture, which uses other")));
}

TEST(ImportGltf, AMissingImageIsReplacedByItsFactor) {
    ModelFiles files;
    files.write("m.gltf", gltfTriangle(files, {0, 0, 1}, R"({"mesh":0})",
                                       R"({"emissiveTexture":{"index":0},"emissiveFactor":[1,0.5,0],
                                 "pbrMetallicRoughness":{"metallicFactor":0.25,"roughnessFactor":0.75,
                                                         "metallicRoughnessTexture":{"index":0}},
                                 "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5,
                                                         "transmissionTexture":{"index":0}}}})",
                                       kExtensions));
    const ImportedModel model = files.import("m.gltf");
    EXPECT_EQ(model.mesh.materials[0].emission, glm::vec4(1, 0.5, 0, 0));
    EXPECT_EQ(model.mesh.materials[0].reflection.x, 0.25f);
    EXPECT_EQ(model.mesh.materials[0].reflection.y, 0.75f);
    EXPECT_EQ(model.mesh.materials[0].transmission.x, 0.5f);
    EXPECT_EQ(model.mesh.materials[0].more.x, kNoImage);
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("its factor stands alone (3 times)")));
}

// Corners have the coordinates (0.25, 0.5), (0, 0.25), (0.5, 0), v downwards as in glTF.
std::vector<glm::vec2> transformedCoordinates(const std::string& transform) {
    ModelFiles files;
    std::string text = gltfTriangle(
        files, {0.25f, 0.5f, 0}, R"({"mesh":0})",
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)" +
            transform + "}}}}",
        kExtensions);
    text.replace(text.find("\"NORMAL\":1"), 10, "\"TEXCOORD_0\":2");
    text.insert(text.find("\"type\":\"VEC3\"}]") + 14,
                R"(,{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"})");
    files.write("m.gltf", text);
    files.write("a.tga", rgbaImage(2, 1, kClearPixels));
    const ImportedModel model = files.import("m.gltf");
    EXPECT_THAT(model.report.warnings, IsEmpty());
    std::vector<glm::vec2> corners;
    for (int i = 0; i < 3; ++i) corners.push_back(model.mesh.texcoords[model.mesh.triangles[0][i]]);
    return corners;
}

void expectCoordinates(const std::string& transform, const std::vector<glm::vec2>& wantedOfGltf) {
    const std::vector<glm::vec2> found = transformedCoordinates(transform);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i].x, wantedOfGltf[i].x, 1e-6f) << transform << " corner " << i;
        EXPECT_NEAR(found[i].y, 1.0f - wantedOfGltf[i].y, 1e-6f) << transform << " corner " << i;
    }
}

TEST(ImportGltf, TextureTransformsAreAppliedToTheCoordinates) {
    expectCoordinates(R"({"offset":[0.5,0.25]})", {{0.75f, 0.75f}, {0.5f, 0.5f}, {1, 0.25f}});
    expectCoordinates(R"({"scale":[2,3]})", {{0.5f, 1.5f}, {0, 0.75f}, {1, 0}});
    // A quarter turn counter-clockwise, v being downwards: (u, v) -> (v, -u).
    expectCoordinates(R"({"rotation":1.5707963267948966})", {{0.5f, -0.25f}, {0.25f, 0}, {0, -0.5f}});
    expectCoordinates(R"({"offset":[0,1],"rotation":1.5707963267948966,"scale":[0.5,2]})",
                      {{1, 0.875f}, {0.5f, 1}, {0, 0.75f}});
}

const Material& find(const ImportedModel& model, bool (*wanted)(const Material&)) {
    const auto found = std::find_if(model.mesh.materials.begin(), model.mesh.materials.end(), wanted);
    EXPECT_NE(found, model.mesh.materials.end());
    return *found;
}

ImportedModel importScene(const std::string& path) {
    StageTimer timer;
    return importModel(path, {}, timer);
}

TEST(ImportGltf, DragonOfGlass) {
    const std::string path = test::scenePath("models/glass/DragonAttenuation.glb");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const ImportedModel model = importScene(path);
    const Material& glass = find(model, [](const Material& m) { return m.transmission.x > 0.0f; });
    EXPECT_GT(glass.transmission.z, 0.0f);
    EXPECT_LT(glass.attenuation.z, glass.attenuation.x); // amber
    EXPECT_EQ(glass.more.y, 0u);
}

TEST(ImportGltf, ScenesWithEachKindOfMaterial) {
    const auto has = [](const char* name, bool (*wanted)(const Material&)) {
        const std::string path = test::scenePath(name);
        return !std::filesystem::exists(path) || (find(importScene(path), wanted), true);
    };
    if (!std::filesystem::exists(test::scenePath("models/gltf"))) GTEST_SKIP() << "scenes are absent";
    EXPECT_TRUE(has("models/interior/vr-gallery.glb",
                    [](const Material& m) { return (m.more.y & kMaterialUnlit) != 0; }));
    EXPECT_TRUE(has("models/interior/house.glb", [](const Material& m) { return m.transmission.w > 0.0f; }));
    EXPECT_TRUE(has("models/gltf/NormalTangentTest.glb",
                    [](const Material& m) { return m.images.y != kNoImage && m.images.z != kNoImage; }));
    EXPECT_TRUE(has("models/glass/TransmissionRoughnessTest.glb", [](const Material& m) {
        return m.transmission.x > 0.0f && m.reflection.y > 0.0f && m.transmission.y != 1.5f;
    }));
    EXPECT_TRUE(has("models/glass/glass-table.glb", [](const Material& m) { return m.baseColor.a < 1.0f; }));
}

} // namespace
} // namespace rt
