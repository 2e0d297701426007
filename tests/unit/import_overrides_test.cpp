// Scene files: what they change of materials.
#include "tests/unit/scene_files.h"
#include "tools/rt-import/scene_description.h"

#include <gmock/gmock.h>

namespace rt {
namespace {

using test::fourColourImage;
using test::SceneFiles;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(SceneFiles, OverridesChangeWhatTheyName) {
    const Material gold = material(R"("baseColor": [1, 0.75, 0.25], "metallic": 1, "roughness": 0.5)");
    EXPECT_EQ(gold.baseColor, glm::vec4(1, 0.75f, 0.25f, 1));
    EXPECT_EQ(gold.reflection, glm::vec4(1, 0.5f, 1, 0));
    const Material glass = material(R"("transmission": 1, "roughness": 0, "attenuationColor": [0.5, 1, 0.75],
        "attenuationDistance": 2)");
    EXPECT_EQ(glass.baseColor, glm::vec4(0.5f, 0.25f, 0.125f, 1)) << "the rest stays";
    EXPECT_EQ(glass.transmission, glm::vec4(1, 1.5f, 2, 0));
    EXPECT_EQ(glass.attenuation, glm::vec4(0.5f, 1, 0.75f, 1));
    EXPECT_EQ(glass.reflection.z, 1.0f);
    const Material told =
        material(R"("transmission": 0.5, "ior": 1.25, "specular": 0.25, "mirror": 0.125, "thin": true)");
    EXPECT_EQ(told.transmission.y, 1.25f);
    EXPECT_EQ(told.reflection.z, 0.25f);
    EXPECT_EQ(told.reflection.w, 0.125f);
    EXPECT_EQ(told.more.y, kMaterialThin);
    const Material lamp = material(R"("emission": 12, "opacity": 0.5, "opacityCutoff": 0.25)");
    EXPECT_EQ(lamp.emission, glm::vec4(12, 12, 12, 0));
    EXPECT_EQ(lamp.baseColor.w, 0.5f);
    EXPECT_EQ(lamp.transmission.w, 0.25f);
    EXPECT_EQ(lamp.more.y, kMaterialClear);
    EXPECT_EQ(lamp.reflection.z, 0.0f) << "it is not made to reflect";
    const Material sign = material(R"("unlit": true, "metallic": 1)");
    EXPECT_EQ(sign.more.y, kMaterialUnlit);
    EXPECT_EQ(sign.reflection, glm::vec4(0, 1, 0, 0));
}

TEST_F(SceneFiles, LaterAndMoreParticularOverridesCount) {
    const Material m = importText(R"({"materials": [{"match": "*", "roughness": 0.9, "metallic": 0.5}],
        "models": [{"file": "t.obj", "materials": [{"match": "st*", "roughness": 0.5},
                                                   {"match": "s?one", "roughness": 0.25}]}]})")
                           .mesh.materials[0];
    EXPECT_EQ(m.reflection.x, 0.5f);
    EXPECT_EQ(m.reflection.y, 0.25f);
}

TEST_F(SceneFiles, AnOverrideOfNothingIsAWarning) {
    const ImportedModel model =
        importText(R"({"materials": [{"match": "Stone", "roughness": 0}], "models": [{"file": "t.obj"}]})");
    EXPECT_THAT(model.report.warnings,
                ElementsAre(HasSubstr("s.scene.json: /materials/0: no material is called 'Stone'")));
    EXPECT_EQ(model.mesh.materials[0].reflection.y, 1.0f);
}

TEST_F(SceneFiles, OverridesGiveAndTakeTextures) {
    write("pictures/four.ppm", fourColourImage());
    write("t.mtl", "newmtl stone\nmap_Kd gone.ppm\n");
    const ImportedModel with = importText(R"({"models": [{"file": "t.obj",
        "materials": [{"match": "stone", "baseColorTexture": "Pictures/FOUR.ppm"}]}]})");
    ASSERT_EQ(with.mesh.images.size(), 1u);
    EXPECT_EQ(with.mesh.materials[0].images.x, 0u);
    EXPECT_THAT(with.report.warnings, IsEmpty()) << "the one that is gone is not asked for";
    EXPECT_THAT(with.filesAsked, HasSubstr("/Pictures/FOUR.ppm"));
    const ImportedModel without = importText(R"({"models": [{"file": "t.obj",
        "materials": [{"match": "stone", "baseColorTexture": null}]}]})");
    EXPECT_EQ(without.mesh.images.size(), 0u);
    EXPECT_THAT(without.report.warnings, IsEmpty());
}

TEST_F(SceneFiles, AnInstanceMayHaveMaterialsOfItsOwn) {
    const ImportedModel model = importText(R"({"models": [{"file": "t.obj",
        "materials": [{"match": "stone", "roughness": 0.5, "ior": 3}],
        "instances": [{}, {"translate": [1, 0, 0], "materials": [{"match": "sto*", "ior": 2}]}, {"translate": [2, 0, 0]},
                      {"translate": [3, 0, 0]}]}]})");
    const Mesh& mesh = model.mesh;
    EXPECT_THAT(model.report.warnings, testing::IsEmpty());
    ASSERT_EQ(mesh.triangles.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(mesh.positions[mesh.triangles[i].x].x, 1.0f + static_cast<float>(i)) << "in their order";
        const Material& material = mesh.materials[mesh.triangleMaterial[i]];
        EXPECT_EQ(material.transmission.y, i == 1 ? 2.0f : 3.0f);
        EXPECT_EQ(material.reflection.y, 0.5f);
    }
}

TEST_F(SceneFiles, PatternsMatchAllOfAName) {
    for (const auto& [pattern, name] : {std::pair("", ""),
                                        {"*", ""},
                                        {"a*c", "abbc"},
                                        {"a*c", "ac"},
                                        {"*b*", "abc"},
                                        {"?", "x"},
                                        {"a*b*c", "a-b-b-c"},
                                        {"**", "x"},
                                        {"*.001", "wood.001"}})
        EXPECT_TRUE(matches(pattern, name)) << pattern << " " << name;
    for (const auto& [pattern, name] :
         {std::pair("", "a"), {"a", "A"}, {"a*c", "abcd"}, {"?", ""}, {"*b", "abc"}})
        EXPECT_FALSE(matches(pattern, name)) << pattern << " " << name;
    EXPECT_FALSE(matches(std::string(2000, '*') + "b", std::string(20000, 'a'))) << "in no time";
}

} // namespace
} // namespace rt
