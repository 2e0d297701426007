// Lights and cameras in world space.
#include "formats/mesh.h"
#include "tests/support/scenes.h"
#include "tests/unit/import_files.h"
#include "tools/rt-import/read_cameras.h"
#include "tools/rt-import/read_lights.h"

#include <assimp/light.h>
#include <assimp/scene.h>
#include <gmock/gmock.h>

#include <cmath>

namespace rt {
namespace {

using test::gltfTriangle;
using test::ModelFiles;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void expectNear(const glm::vec3& found, const glm::vec3& wanted) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-5f) << "component " << i;
}

glm::vec3 vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// The node of a light or camera, {...}, below one that lifts it by 5 along z.
ImportedModel importWith(const std::string& nodes, const std::string& children, const std::string& extra) {
    ModelFiles files;
    files.write("m.gltf",
                gltfTriangle(files, {0, 0, 1},
                             R"({"mesh":0,"translation":[0,0,5],"children":)" + children + "}," + nodes, "{}",
                             R"(,"extensionsUsed":["KHR_lights_punctual"])" + extra));
    return files.import("m.gltf");
}

ImportedModel importLight(const std::string& placement, const std::string& light) {
    return importWith("{" + placement + R"("extensions":{"KHR_lights_punctual":{"light":0}}})", "[1]",
                      R"(,"extensions":{"KHR_lights_punctual":{"lights":[)" + light + "]}}");
}

// Half a turn about the y axis.
const std::string kTurned = R"("rotation":[0,1,0,0],"translation":[1,2,3],)";

TEST(ImportLights, APointOfGltfKeepsItsCandela) {
    const ImportedModel model =
        importLight(kTurned, R"({"type":"point","color":[1,0.5,0.25],"intensity":100})");
    ASSERT_EQ(model.mesh.lights.size(), 1u);
    const Light& light = model.mesh.lights[0];
    EXPECT_EQ(light.kind.x, kLightPoint);
    EXPECT_EQ(light.position, glm::vec4(1, 2, 8, 0));
    EXPECT_EQ(light.intensity, glm::vec4(100, 50, 25, 0));
    EXPECT_THAT(model.report.warnings, IsEmpty());
}

TEST(ImportLights, ADirectionalLightKeepsItsLux) {
    const ImportedModel model = importLight(kTurned, R"({"type":"directional","intensity":3})");
    ASSERT_EQ(model.mesh.lights.size(), 1u);
    const Light& light = model.mesh.lights[0];
    EXPECT_EQ(light.kind.x, kLightDirectional);
    EXPECT_EQ(light.intensity, glm::vec4(3, 3, 3, 0));
    expectNear(glm::vec3(light.direction), {0, 0, 1}); // -z, turned
    EXPECT_THAT(model.report.warnings, IsEmpty());
}

TEST(ImportLights, ASpotKeepsItsCones) {
    const ImportedModel model = importLight(
        kTurned, R"({"type":"spot","intensity":2,"spot":{"innerConeAngle":0.25,"outerConeAngle":0.5}})");
    ASSERT_EQ(model.mesh.lights.size(), 1u);
    const Light& light = model.mesh.lights[0];
    EXPECT_EQ(light.kind.x, kLightSpot);
    EXPECT_EQ(light.position, glm::vec4(1, 2, 8, 0));
    expectNear(glm::vec3(light.direction), {0, 0, 1});
    EXPECT_NEAR(light.direction.w, std::cos(0.5f), 1e-6f);
    EXPECT_NEAR(light.edgeU.w, std::cos(0.25f), 1e-6f);
}

TEST(ImportLights, ALightAtTwoNodesIsTwoLights) {
    const std::string shown = R"("extensions":{"KHR_lights_punctual":{"light":0}}})";
    const ImportedModel model = importWith(
        R"({"name":"same","translation":[1,0,0],)" + shown + R"(,{"name":"same","translation":[2,0,0],)" +
            shown +
            R"(,{"children":[4]},{"translation":[3,0,0],"extensions":{"KHR_lights_punctual":{"light":1}}})",
        "[1,2,3]",
        R"(,"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":7},
                       {"type":"point","intensity":9}]}})");
    std::vector<glm::vec2> placesAndIntensities;
    for (const Light& light : model.mesh.lights)
        placesAndIntensities.emplace_back(light.position.x, light.intensity.x);
    EXPECT_THAT(placesAndIntensities,
                testing::UnorderedElementsAre(glm::vec2(1, 7), glm::vec2(2, 7), glm::vec2(3, 9)));
}

// None of the formats that are read has these, so that they are made here.
struct SceneWithLight {
    aiScene scene;
    aiLight* light = new aiLight;

    SceneWithLight() {
        scene.mRootNode = new aiNode("root");
        scene.mLights = new aiLight* [1] { light };
        scene.mNumLights = 1;
        light->mName = "root";
        light->mColorDiffuse = aiColor3D(1, 2, 3);
    }
    std::vector<Light> read(SceneryStyle style = SceneryStyle::Gltf) {
        return readLights(scene, {}, glm::vec3(0, 0, -2), style, warnings);
    }
    std::vector<std::string> warnings;
};

TEST(ImportLights, AnAreaBecomesARectangle) {
    SceneWithLight s;
    s.light->mType = aiLightSource_AREA;
    s.light->mDirection = aiVector3D(0, -1, 0);
    s.light->mUp = aiVector3D(0, 0, 1);
    s.light->mSize = aiVector2D(4, 2);
    s.scene.mRootNode->mTransformation = aiMatrix4x4(2, 0, 0, 1, 0, 1, 0, 7, 0, 0, 1, 0, 0, 0, 0, 1);
    const std::vector<Light> lights = s.read();
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_EQ(lights[0].kind.x, kLightRectangle);
    EXPECT_EQ(lights[0].position, glm::vec4(1, 7, 0, 0));
    EXPECT_EQ(lights[0].intensity, glm::vec4(1, 2, 3, 0));
    expectNear(glm::vec3(lights[0].direction), {0, -1, 0});
    expectNear(glm::abs(glm::vec3(lights[0].edgeU)), {4, 0, 0});
    expectNear(glm::abs(glm::vec3(lights[0].edgeV)), {0, 0, 1});
    EXPECT_THAT(s.warnings, IsEmpty());
}

TEST(ImportLights, ASkewedAreaKeepsItsAreaAndRightAngles) {
    SceneWithLight s;
    s.light->mType = aiLightSource_AREA;
    s.light->mDirection = aiVector3D(0, 0, 1);
    s.light->mUp = aiVector3D(0, 1, 0);
    s.light->mSize = aiVector2D(2, 2);
    s.scene.mRootNode->mTransformation = aiMatrix4x4(1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    const std::vector<Light> lights = s.read();
    ASSERT_EQ(lights.size(), 1u);
    const glm::vec3 u(lights[0].edgeU), v(lights[0].edgeV);
    EXPECT_NEAR(glm::dot(u, v), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::length(glm::cross(u, v)), 1.0f, 1e-6f);
    expectNear(glm::vec3(lights[0].direction), {0, 0, 1});
}

TEST(ImportLights, AConeOf3dsIsMeasuredAcross) {
    SceneWithLight s;
    s.light->mType = aiLightSource_SPOT;
    s.light->mDirection = aiVector3D(0, 0, -2);
    s.light->mAngleInnerCone = 0.5f;
    s.light->mAngleOuterCone = 1.0f;
    s.light->mAttenuationLinear = 0.0f; // no fall-off
    const std::vector<Light> lights = s.read(SceneryStyle::Classic);
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_NEAR(lights[0].direction.w, std::cos(0.5f), 1e-6f);
    EXPECT_NEAR(lights[0].edgeU.w, std::cos(0.25f), 1e-6f);
    EXPECT_NEAR(lights[0].intensity.x, 4.0f * 3.14159265f, 1e-5f); // the centre is 2 away
    EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("1 lights do not fall off")));
}

TEST(ImportLights, OneOfTheClassicStyleIsAsBrightAtTheCentreAsItsFileSays) {
    SceneWithLight s;
    s.light->mType = aiLightSource_POINT;
    s.light->mAttenuationConstant = 1.0f;
    s.light->mAttenuationLinear = 0.5f;
    s.light->mAttenuationQuadratic = 0.25f;
    // White shows the colour over 1 + 0.5 * 2 + 0.25 * 4, and ours intensity / (pi 2^2).
    EXPECT_NEAR(s.read(SceneryStyle::Classic)[0].intensity.x, 4.0f * 3.14159265f / 3.0f, 1e-5f);
    EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("1 lights do not fall off")));
    s.light->mAttenuationConstant = s.light->mAttenuationLinear = 0.0f;
    s.warnings.clear();
    EXPECT_NEAR(s.read(SceneryStyle::Classic)[0].intensity.x, 4.0f * 3.14159265f, 1e-5f);
    EXPECT_EQ(s.read(SceneryStyle::Gltf)[0].intensity.x, 1.0f);
    EXPECT_THAT(s.warnings, IsEmpty());
    s.light->mType = aiLightSource_DIRECTIONAL;
    s.light->mDirection = aiVector3D(0, 0, -1);
    EXPECT_NEAR(s.read(SceneryStyle::Classic)[0].intensity.x, 3.14159265f, 1e-6f);
}

TEST(ImportLights, AmbientAndBrokenOnesAreCounted) {
    SceneWithLight ambient;
    ambient.light->mType = aiLightSource_AMBIENT;
    EXPECT_THAT(ambient.read(), IsEmpty());
    EXPECT_THAT(ambient.warnings, ElementsAre(HasSubstr("1 lights are neither")));
    SceneWithLight flat;
    flat.light->mType = aiLightSource_AREA;
    EXPECT_THAT(flat.read(), IsEmpty());
    EXPECT_THAT(flat.warnings, ElementsAre(HasSubstr("1 lights are not finite or have no")));
}

TEST(ImportCameras, APerspectiveOneStandsInTheWorld) {
    for (const auto& [extra, name] : {std::pair("", "without"), {R"("aspectRatio":2,)", "with"}}) {
        const ImportedModel model =
            importWith("{" + kTurned + R"("camera":0,"name":")" + name + R"("})", "[1]",
                       std::string(R"(,"cameras":[{"type":"perspective","perspective":{)") + extra +
                           R"("yfov":0.8,"znear":0.1}}])");
        ASSERT_EQ(model.mesh.cameras.size(), 1u);
        const NamedCamera& camera = model.mesh.cameras[0];
        EXPECT_STREQ(camera.name, name);
        EXPECT_EQ(camera.kind, kCameraPerspective);
        expectNear(vectorOf(camera.eye), {1, 2, 8}); // its translation counts once
        expectNear(vectorOf(camera.lookAt), {1, 2, 9});
        expectNear(vectorOf(camera.up), {0, 1, 0});
        EXPECT_NEAR(camera.fovDegrees, 0.8 * 180.0 / 3.14159265358979, 1e-5);
        EXPECT_EQ(camera.lensRadius, 0.0);
    }
}

TEST(ImportCameras, AnOrthographicOneKeepsItsHeight) {
    const ImportedModel model = importWith(
        R"({"camera":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,4,5,6,1]})", "[1]",
        R"(,"cameras":[{"type":"orthographic","orthographic":{"xmag":3,"ymag":2,"znear":0.1,"zfar":9}}])");
    ASSERT_EQ(model.mesh.cameras.size(), 1u);
    const NamedCamera& camera = model.mesh.cameras[0];
    EXPECT_EQ(camera.kind, kCameraOrthographic);
    EXPECT_NEAR(camera.height, 4.0, 1e-6);
    expectNear(vectorOf(camera.eye), {4, 5, 11});
}

TEST(ImportCameras, NamesAreUniqueAndClippedWhereACharacterEnds) {
    const std::string name(62, 'x'); // and a character of two bytes, of which one would fit
    std::string nodes, cameras;
    for (const char* number : {"0", "1", "2"}) {
        const std::string comma = nodes.empty() ? "" : ",";
        nodes += comma + R"({"name":")" + name + "\u00e9" + R"(","camera":)" + number + "}";
        cameras += comma + R"({"type":"perspective","perspective":{"yfov":1,"znear":0.1}})";
    }
    const ImportedModel model = importWith(nodes, "[1,2,3]", R"(,"cameras":[)" + cameras + "]");
    ASSERT_EQ(model.mesh.cameras.size(), 3u);
    EXPECT_EQ(std::string(model.mesh.cameras[0].name), name);
    EXPECT_EQ(std::string(model.mesh.cameras[1].name), std::string(61, 'x') + ".1");
    EXPECT_EQ(std::string(model.mesh.cameras[2].name), std::string(61, 'x') + ".2");
}

TEST(ImportCameras, ACameraAtTwoNodesIsTwoCameras) {
    const ImportedModel model = importWith(
        R"({"name":"a","camera":0,"translation":[1,0,0]},{"name":"b","camera":0,"translation":[2,0,0]})",
        "[1,2]", R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}])");
    ASSERT_EQ(model.mesh.cameras.size(), 2u);
    EXPECT_STREQ(model.mesh.cameras[0].name, "a");
    expectNear(vectorOf(model.mesh.cameras[0].eye), {1, 0, 5});
    EXPECT_STREQ(model.mesh.cameras[1].name, "b");
    expectNear(vectorOf(model.mesh.cameras[1].eye), {2, 0, 5});
}

TEST(ImportCameras, AnAngleOfTheWidthBecomesOneOfTheHeight) {
    aiScene scene;
    scene.mRootNode = new aiNode("root");
    scene.mCameras = new aiCamera* [1] { new aiCamera };
    scene.mNumCameras = 1;
    scene.mCameras[0]->mHorizontalFOV = 2.0f * std::atan(1.5f * std::tan(0.3f));
    scene.mCameras[0]->mAspect = 1.5f;
    std::vector<std::string> warnings;
    const auto fov = [&] { return readCameras(scene, {}, SceneryStyle::Classic, warnings).at(0).fovDegrees; };
    EXPECT_NEAR(fov(), 0.6 * 180.0 / 3.14159265358979, 1e-4);
    scene.mCameras[0]->mAspect = 0.0f;
    EXPECT_NEAR(fov(), 2.0 * std::atan(1.5 * std::tan(0.3)) * 180.0 / 3.14159265358979, 1e-4);
}

TEST(ImportCameras, TheOneOfTheEngineIsRead) {
    const std::string path = test::scenePath("models/gltf/2CylinderEngine.glb");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    StageTimer timer;
    const ImportedModel model = importModel(path, {}, timer);
    ASSERT_EQ(model.mesh.cameras.size(), 1u);
    EXPECT_NEAR(model.mesh.cameras[0].eye[0], 1005.99, 0.01);
    EXPECT_GT(model.mesh.cameras[0].fovDegrees, 1.0);
}

} // namespace
} // namespace rt
