// Scene files: the lights, cameras and surroundings that they add.
#include "formats/image_exr.h"
#include "tests/unit/scene_files.h"

#include <gmock/gmock.h>

#include <cmath>

namespace rt {
namespace {

using test::expectNear;
using test::gltfTriangle;
using test::SceneFiles;
using test::vectorOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

TEST_F(SceneFiles, LightsOfAllKinds) {
    const auto lights = importText(R"({"models": [{"file": "t.obj"}], "lights": [
        {"kind": "point", "position": [1, 2, 3], "intensity": [4, 5, 6]},
        {"kind": "directional", "direction": [0, -2, 0], "intensity": 3},
        {"kind": "spot", "position": [0, 4, 0], "lookAt": [0, 0, 0], "outerAngle": 60, "innerAngle": 30, "intensity": 1},
        {"kind": "rectangle", "position": [0, 4, 0], "direction": [0, -1, 0], "width": 2, "height": 6, "intensity": 7},
        {"kind": "sphere", "position": [0, 0, 9], "radius": 0.5, "intensity": 8}]})")
                            .mesh.lights;
    ASSERT_EQ(lights.size(), 5u);
    for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(lights[i].kind.x, i) << "in the order of their constants";
    EXPECT_EQ(lights[0].position, glm::vec4(1, 2, 3, 0));
    EXPECT_EQ(lights[0].intensity, glm::vec4(4, 5, 6, 0));
    EXPECT_EQ(glm::vec3(lights[1].direction), glm::vec3(0, -1, 0));
    EXPECT_EQ(glm::vec3(lights[2].direction), glm::vec3(0, -1, 0));
    EXPECT_NEAR(lights[2].direction.w, 0.5f, 1e-6f);
    EXPECT_NEAR(lights[2].edgeU.w, std::cos(30.0 * kDegree), 1e-6);
    EXPECT_NEAR(glm::length(glm::vec3(lights[3].edgeU)), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::length(glm::vec3(lights[3].edgeV)), 3.0f, 1e-6f);
    expectNear(glm::vec3(lights[3].direction), {0, -1, 0});
    EXPECT_EQ(lights[4].position, glm::vec4(0, 0, 9, 0.5f));
    EXPECT_EQ(lights[4].intensity, glm::vec4(8, 8, 8, 0));
}

TEST_F(SceneFiles, CamerasOfAllKindsAndTheirPaths) {
    const Mesh mesh = importText(R"({"models": [{"file": "t.obj"}], "cameras": [
        {"name": "near", "eye": [0, 0, 4], "lookAt": [0, 0, 0], "fov": 30, "lensRadius": 0.25},
        {"name": "plan", "kind": "orthographic", "eye": [0, 9, 0], "lookAt": [0, 0, 0], "up": [0, 0, -2], "height": 3},
        {"name": "round", "kind": "panorama", "eye": [0, 1, 0], "lookAt": [1, 1, 0]},
        {"name": "tour", "fov": 50, "path": [{"frame": 1, "eye": [1, 0, 4], "lookAt": [0, 0, 0]},
                                             {"frame": 9, "eye": [2, 0, 4], "lookAt": [0, 0, 0], "fov": 20}]}]})")
                          .mesh;
    ASSERT_EQ(mesh.cameras.size(), 4u);
    EXPECT_EQ(mesh.cameras[0].fovDegrees, 30.0);
    EXPECT_EQ(mesh.cameras[0].lensRadius, 0.25);
    EXPECT_EQ(mesh.cameras[0].focusDistance, 4.0) << "what is looked at is in focus";
    EXPECT_EQ(mesh.cameras[1].kind, kCameraOrthographic);
    EXPECT_EQ(mesh.cameras[1].height, 3.0);
    expectNear(vectorOf(mesh.cameras[1].up), {0, 0, -1});
    EXPECT_EQ(mesh.cameras[2].kind, kCameraPanorama);
    EXPECT_STREQ(mesh.cameras[3].name, "tour");
    expectNear(vectorOf(mesh.cameras[3].eye), {1, 0, 4});
    ASSERT_EQ(mesh.cameraKeys.size(), 2u);
    EXPECT_EQ(mesh.cameraKeys[0].frame, 1.0);
    EXPECT_EQ(mesh.cameraKeys[0].fovDegrees, 50.0);
    EXPECT_EQ(mesh.cameraKeys[1].fovDegrees, 20.0);
    EXPECT_EQ(mesh.cameraKeys[1].camera, 3u);
    expectNear(mesh.cameraKeys[1].eye, {2, 0, 4});
}

TEST_F(SceneFiles, AModelsOwnLightsAndCamerasMoveWithIt) {
    const std::string extra =
        R"(,"extensionsUsed":["KHR_lights_punctual"],"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":8}]}})";
    std::string gltf =
        gltfTriangle(*this, {0, 0, 1},
                     R"({"mesh":0,"children":[1]},{"name":"lamp","camera":0,"translation":[1,2,3],
            "extensions":{"KHR_lights_punctual":{"light":0}}})",
                     "{}", extra);
    write("m.gltf", gltf);
    const std::string instances = R"("instances": [{"scale": 2}, {"translate": [0, 0, 10]}])";
    const Mesh mesh = importText(R"({"models": [{"file": "m.gltf", )" + instances + "}]}").mesh;
    ASSERT_EQ(mesh.lights.size(), 2u);
    EXPECT_EQ(mesh.lights[0].position, glm::vec4(2, 4, 6, 0));
    EXPECT_EQ(mesh.lights[0].intensity.x, 32.0f);
    EXPECT_EQ(mesh.lights[1].position, glm::vec4(1, 2, 13, 0));
    ASSERT_EQ(mesh.cameras.size(), 2u);
    EXPECT_STREQ(mesh.cameras[1].name, "lamp.1");
    expectNear(vectorOf(mesh.cameras[0].eye), {2, 4, 6});
    const Mesh bare = importText(R"({"models": [{"file": "m.gltf", "lights": false, "cameras": false, )" +
                                 instances + "}]}")
                          .mesh;
    EXPECT_TRUE(bare.lights.empty());
    EXPECT_TRUE(bare.cameras.empty());
}

TEST_F(SceneFiles, LightsThatATransformTakesOutOfRangeAreLeftOut) {
    write("m.gltf",
          gltfTriangle(*this, {0, 0, 1}, R"({"mesh":0,"extensions":{"KHR_lights_punctual":{"light":0}}})",
                       "{}", R"(,"extensionsUsed":["KHR_lights_punctual"],"extensions":{
        "KHR_lights_punctual":{"lights":[{"type":"point","intensity":1e20}]}})"));
    const ImportedModel model =
        importText(R"({"models": [{"file": "m.gltf", "transform": {"scale": 1e10}}]})");
    EXPECT_TRUE(model.mesh.lights.empty());
    EXPECT_THAT(model.report.warnings, ElementsAre(HasSubstr("1 lights are out of range")));
}

TEST_F(SceneFiles, SurroundingsComeAlong) {
    Image sky;
    sky.width = 2;
    sky.height = 1;
    for (const char* name : {"B", "G", "R"})
        sky.channels.push_back({name, ImageChannel::Type::Float, {0.5f, 1000.0f}, {}});
    writeImage(path("sky.exr"), sky);
    const Mesh mesh = importText(R"({"models": [{"file": "t.obj"}], "background": [1, 2, 3],
        "environment": {"file": "sky.exr", "strength": 1.5, "turn": -450}})")
                          .mesh;
    ASSERT_EQ(mesh.surroundings.size(), 1u);
    const Surroundings& around = mesh.surroundings[0];
    EXPECT_EQ(around.hasBackground, 1u);
    EXPECT_EQ(around.background[2], 3.0f);
    EXPECT_EQ(around.strength, 1.5f);
    EXPECT_EQ(around.turnDegrees, -90.0f);
    EXPECT_EQ(around.width, 2u);
    EXPECT_THAT(std::vector(mesh.environment.begin(), mesh.environment.end()),
                ElementsAre(glm::vec3(0.5f), glm::vec3(1000.0f)));
    const Mesh even =
        importText(R"({"models": [{"file": "t.obj"}], "environment": {"color": [1, 0.5, 0]}})").mesh;
    EXPECT_EQ(even.surroundings[0].hasBackground, 0u);
    EXPECT_EQ(even.environment[0], glm::vec3(1, 0.5f, 0));
    EXPECT_TRUE(importText(R"({"models": [{"file": "t.obj"}]})").mesh.surroundings.empty());
}

} // namespace
} // namespace rt
