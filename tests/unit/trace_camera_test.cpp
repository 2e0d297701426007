// The default camera and lights of rt-trace.
#include "common/error.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/lights.h"
#include "tools/rt-trace/turntable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace rt {
namespace {

const BoundsD kBoxes[] = {
    {{-1, -1, -1}, {1, 1, 1}},
    {{0, 0, 0}, {100, 1, 3}},
    {{5, 5, 5}, {6, 900, 6}},
    {{-2, -3, 7}, {2, 3, 7}},
    {{-40, 1, -40}, {40, 1, 40}},
    {{148376, 1234, -223424}, {148377, 1235, -223423}},
    {{-1e-6, 0, 0}, {1e-6, 2e-6, 0}},
    {{3, 4, 5}, {3, 4, 5}},
    {{-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}},
};

// Position in the picture: x and y are within -1..1 inside it; z is the depth.
glm::dvec3 project(const CameraPose& pose, double aspect, const glm::dvec3& point) {
    const CameraBasis basis = basisOf(pose, aspect);
    const glm::dvec3 offset = point - pose.eye;
    const double depth = glm::dot(offset, basis.forward);
    return {glm::dot(offset, basis.right) / (depth * basis.halfWidth),
            glm::dot(offset, basis.up) / (depth * basis.halfHeight), depth};
}

glm::dvec3 corner(const BoundsD& box, int i) {
    return {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
}

TEST(DefaultCamera, EveryCornerIsInsideThePictureAndThePictureIsFilled) {
    for (const BoundsD& box : kBoxes)
        for (const double aspect : {1.0, 16.0 / 9.0, 0.25, 8.0})
            for (const double fov : {10.0, 40.0, 120.0}) {
                const CameraPose pose = placeCamera({{}, {}, {}, fov}, box, aspect);
                double widest = 0.0;
                for (int i = 0; i < 8; ++i) {
                    const glm::dvec3 p = project(pose, aspect, corner(box, i));
                    EXPECT_GT(p.z, 0.0);
                    EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 1.0);
                    widest = std::max({widest, std::abs(p.x), std::abs(p.y)});
                }
                const bool fills = fov < 90.0 && box.extent() != glm::dvec3(0.0);
                EXPECT_GT(widest, fills ? 0.8 : -1.0);
            }
}

TEST(Turntable, EveryCornerIsInsideThePictureInEveryFrame) {
    for (const unsigned view : {kPerspectiveView, kOrthographicView})
        for (const BoundsD& box : kBoxes) {
            CameraRequest request;
            request.view = view;
            const CameraPose first = placeTurntable(request, box, 1.5);
            double widest = 0.0;
            for (int frame = 0; frame < 100; ++frame) {
                const CameraPose pose = placeCamera(turnedCamera(first, 3.6 * frame, request), box, 1.5);
                const CameraBasis basis = basisOf(pose, 1.5);
                for (int i = 0; i < 8; ++i) {
                    const glm::dvec3 offset = corner(box, i) - pose.eye;
                    const double depth = view == kPerspectiveView ? glm::dot(offset, basis.forward) : 1.0;
                    EXPECT_GT(depth, 0.0);
                    const double x = std::abs(glm::dot(offset, basis.right)) / (depth * basis.halfWidth);
                    const double y = std::abs(glm::dot(offset, basis.up)) / (depth * basis.halfHeight);
                    widest = std::max({widest, x, y});
                }
            }
            EXPECT_LE(widest, 1.0);
            EXPECT_GT(widest, box.extent() == glm::dvec3(0.0) ? -1.0 : 0.8);
        }
}

TEST(Turntable, GoesRoundWhatItLooksAtToTheRightAndKeepsAGivenEye) {
    CameraRequest request;
    request.eye = glm::dvec3(0, 1, 5);
    request.lookAt = glm::dvec3(0, 1, 0);
    const CameraPose first = placeTurntable(request, kBoxes[0], 1.0);
    EXPECT_EQ(first.eye, *request.eye);
    const CameraPose quarter = placeCamera(turnedCamera(first, 90.0, request), kBoxes[0], 1.0);
    EXPECT_LT(glm::distance(quarter.eye, glm::dvec3(5, 1, 0)), 1e-12);
    EXPECT_EQ(quarter.lookAt, first.lookAt);
}

TEST(DefaultCamera, FitsTheSceneAroundAnotherLookAtPoint) {
    const BoundsD& box = kBoxes[1];
    CameraRequest request;
    request.lookAt = glm::dvec3(0, 0, 0);
    const CameraPose pose = placeCamera(request, box, 1.5);
    EXPECT_EQ(pose.lookAt, *request.lookAt);
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 p = project(pose, 1.5, corner(box, i));
        EXPECT_GT(p.z, 0.0);
        EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 1.0);
    }
}

TEST(DefaultCamera, UpIsYUnlessTheViewIsAlongIt) {
    CameraRequest request;
    EXPECT_EQ(placeCamera(request, kBoxes[0], 1.0).up, glm::dvec3(0, 1, 0));
    request.eye = glm::dvec3(0, 9, 0);
    const CameraPose above = placeCamera(request, kBoxes[0], 1.0);
    EXPECT_EQ(above.up, glm::dvec3(0, 0, 1));
    EXPECT_NEAR(basisOf(above, 1.0).up.z, 1.0, 1e-12);
}

ErrorKind kindOf(const CameraRequest& request) {
    try {
        placeCamera(request, kBoxes[0], 1.0);
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::Internal;
}

TEST(Camera, ViewsThatHaveNoDirectionAreUsageErrors) {
    const glm::dvec3 point(1, 2, 3);
    EXPECT_EQ(kindOf({point, point, {}, 40.0}), ErrorKind::Usage);
    EXPECT_EQ(kindOf({glm::dvec3(0, 0, 5), glm::dvec3(0), glm::dvec3(0, 0, -2), 40.0}), ErrorKind::Usage);
    EXPECT_EQ(kindOf({glm::dvec3(0, 0, 5), glm::dvec3(0), glm::dvec3(0), 40.0}), ErrorKind::Usage);
    for (const double fov : {0.0, 180.0, -10.0, std::nan("")})
        EXPECT_EQ(kindOf({{}, {}, {}, fov}), ErrorKind::Usage);
}

TEST(Camera, AtlasSpaceIsReachedInDoublePrecision) {
    GridParams grid{};
    grid.worldOffset = glm::vec4(148376.0f, 1234.0f, -223424.0f, 0.5f);
    CameraPose pose;
    pose.eye = glm::dvec3(148376.125, 1234.0 + 1e-9, -223420.0);
    pose.lookAt = glm::dvec3(grid.worldOffset);
    const CameraParams params = cameraInAtlas(pose, 2.0, grid);
    EXPECT_EQ(params.eye, glm::vec4(0.0625f, float((pose.eye.y - 1234.0) * 0.5), 2.0f, 0.0f));
    EXPECT_NEAR(glm::length(glm::vec3(params.forward)), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::length(glm::vec3(params.right)), 2.0f * glm::length(glm::vec3(params.up)), 1e-6f);
}

NamedCamera named(const std::string& name, std::uint32_t kind) {
    NamedCamera camera{};
    name.copy(camera.name, sizeof camera.name - 1);
    camera.eye[2] = 5.0;
    camera.lookAt[0] = 1.0;
    camera.up[1] = 1.0;
    camera.fovDegrees = 25.0;
    camera.height = 3.0;
    camera.lensRadius = kind == kCameraPerspective ? 0.5 : 0.0;
    camera.focusDistance = 4.0;
    camera.kind = kind;
    return camera;
}

TEST(NamedCameras, GiveWhatTheRequestLeavesOpen) {
    const NamedCamera cameras[] = {named("a", kCameraPerspective), named("top", kCameraOrthographic)};
    CameraRequest request;
    EXPECT_FALSE(withNamedCamera(request, cameras).eye) << "no name, no camera";
    request.name = "a";
    CameraPose pose = placeCamera(withNamedCamera(request, cameras), kBoxes[0], 1.0);
    EXPECT_EQ(pose.eye, glm::dvec3(0, 0, 5));
    EXPECT_EQ(pose.lookAt, glm::dvec3(1, 0, 0));
    EXPECT_EQ(pose.fovDegrees, 25.0);
    EXPECT_EQ(pose.lensRadius, 0.5);
    EXPECT_EQ(pose.focusDistance, 4.0);
    request.eye = glm::dvec3(0, 1, 7);
    request.fovDegrees = 30.0;
    request.lensRadius = 0.0;
    pose = placeCamera(withNamedCamera(request, cameras), kBoxes[0], 1.0);
    EXPECT_EQ(pose.eye, glm::dvec3(0, 1, 7));
    EXPECT_EQ(pose.lookAt, glm::dvec3(1, 0, 0));
    EXPECT_EQ(pose.fovDegrees, 30.0);
    EXPECT_EQ(pose.lensRadius, 0.0);
    request = {};
    request.name = "top";
    pose = placeCamera(withNamedCamera(request, cameras), kBoxes[0], 1.0);
    EXPECT_EQ(pose.view, kOrthographicView);
    EXPECT_EQ(pose.height, 3.0);
}

// What a camera says of its own kind is nothing to a picture of another.
TEST(NamedCameras, OfAnotherKindGiveTheirPlaceOnly) {
    const NamedCamera cameras[] = {named("a", kCameraPerspective), named("top", kCameraOrthographic)};
    CameraRequest request;
    request.name = "a";
    request.view = kOrthographicView;
    CameraPose pose = placeCamera(withNamedCamera(request, cameras), kBoxes[0], 1.0);
    EXPECT_EQ(pose.eye, glm::dvec3(0, 0, 5));
    EXPECT_GT(pose.height, 2.0);
    EXPECT_EQ(pose.lensRadius, 0.0);
    request.name = "top";
    request.view = kPerspectiveView;
    pose = placeCamera(withNamedCamera(request, cameras), kBoxes[0], 1.0);
    EXPECT_EQ(pose.fovDegrees, kDefaultFovDegrees);
}

TEST(Camera, NumbersThatSayNothingOfItsKindAreUsageErrors) {
    CameraRequest flat;
    flat.view = kOrthographicView;
    EXPECT_EQ(kindOf(flat), ErrorKind::Internal) << "no error";
    flat.fovDegrees = 30.0;
    EXPECT_EQ(kindOf(flat), ErrorKind::Usage);
    CameraRequest sharp;
    sharp.focusDistance = 3.0;
    EXPECT_EQ(kindOf(sharp), ErrorKind::Usage);
    sharp.lensRadius = 0.0;
    EXPECT_EQ(kindOf(sharp), ErrorKind::Usage);
    sharp.lensRadius = 0.1;
    EXPECT_EQ(kindOf(sharp), ErrorKind::Internal);
    CameraRequest tall;
    tall.height = 3.0;
    EXPECT_EQ(kindOf(tall), ErrorKind::Usage);
}

TEST(NamedCameras, AnUnknownNameIsAnsweredWithThoseThatThereAre) {
    const NamedCamera cameras[] = {named("a", kCameraPerspective), named("top", kCameraOrthographic)};
    CameraRequest request;
    request.name = "side";
    try {
        withNamedCamera(request, cameras);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Usage);
        EXPECT_NE(std::string(error.what()).find("a, top"), std::string::npos) << error.what();
    }
}

TEST(Camera, AnOrthographicPictureHoldsTheWholeScene) {
    for (const BoundsD& box : kBoxes)
        for (const double aspect : {0.5, 2.0}) {
            CameraRequest request;
            request.view = kOrthographicView;
            const CameraPose pose = placeCamera(request, box, aspect);
            const CameraBasis basis = basisOf(pose, aspect);
            for (int corner = 0; corner < 8; ++corner) {
                const glm::dvec3 point(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                       corner & 4 ? box.hi.z : box.lo.z);
                const glm::dvec3 offset = point - pose.eye;
                EXPECT_GT(glm::dot(offset, basis.forward), 0.0);
                EXPECT_LT(std::abs(glm::dot(offset, basis.right)), basis.halfWidth);
                EXPECT_LT(std::abs(glm::dot(offset, basis.up)), basis.halfHeight);
            }
        }
}

TEST(Camera, LensFocusAndOrthographicSizesAreLengthsInAtlasSpace) {
    GridParams grid{};
    grid.worldOffset = glm::vec4(0.0f, 0.0f, 0.0f, 4.0f);
    CameraPose pose;
    pose.eye = glm::dvec3(0, 0, 10);
    pose.lensRadius = 0.25;
    pose.focusDistance = 10.0;
    CameraParams params = cameraInAtlas(pose, 1.0, grid);
    EXPECT_EQ(params.eye.w, 1.0f);
    EXPECT_EQ(params.forward.w, 40.0f);
    pose.view = kOrthographicView;
    pose.height = 3.0;
    params = cameraInAtlas(pose, 2.0, grid);
    EXPECT_NEAR(glm::length(glm::vec3(params.up)), 6.0f, 1e-6f);
    EXPECT_NEAR(glm::length(glm::vec3(params.right)), 12.0f, 1e-6f);
}

TEST(Camera, APanoramaStandsInTheSceneAndLooksAlongMinusZ) {
    CameraRequest request;
    request.view = kPanoramaView;
    const CameraPose pose = placeCamera(request, kBoxes[0], 2.0);
    EXPECT_EQ(pose.eye, kBoxes[0].centre());
    EXPECT_EQ(basisOf(pose, 2.0).forward, glm::dvec3(0, 0, -1));
    request.eye = glm::dvec3(3, 2, 1);
    EXPECT_EQ(basisOf(placeCamera(request, kBoxes[0], 2.0), 2.0).forward, glm::dvec3(0, 0, -1));
    request.lensRadius = 0.1;
    EXPECT_THROW(placeCamera(request, kBoxes[0], 2.0), Error);
}

Atlas atlasWithScale(float scale, float offset = 10.0f) {
    Atlas atlas;
    atlas.grid.worldOffset = glm::vec4(offset, 0.0f, 0.0f, scale);
    return atlas;
}

// Radiance of a white surface at the point that faces the light, all in atlas space.
double facingRadiance(const Light& light, const glm::dvec3& atlasPoint) {
    const double d = glm::distance(glm::dvec3(light.position), atlasPoint);
    return light.intensity.x / (M_PI * d * d);
}

TEST(Lights, DefaultsLightTheCentreTheSameAtAnyScale) {
    for (const float scale : {0x1p-20f, 1.0f, 0x1p20f}) {
        const Atlas atlas = atlasWithScale(scale, 10.0f / scale);
        const BoundsD scene{glm::dvec3(10, -1, -1) / double(scale), glm::dvec3(12, 1, 1) / double(scale)};
        const auto lights = chooseLights({}, atlas, scene, placeCamera({}, scene, 1.0));
        ASSERT_EQ(lights.size(), 2u);
        const glm::dvec3 centre(1, 0, 0);
        EXPECT_NEAR(facingRadiance(lights[0], centre), 0.9, 1e-4);
        EXPECT_NEAR(facingRadiance(lights[1], centre), 0.25, 1e-4);
    }
}

TEST(Lights, OfTheCommandLineReplaceThoseOfTheSceneWhichReplaceTheDefaults) {
    Atlas atlas = atlasWithScale(0.5f);
    const BoundsD scene{glm::dvec3(9, -1, -1), glm::dvec3(11, 1, 1)};
    const CameraPose pose = placeCamera({}, scene, 1.0);
    atlas.lights = std::vector<Light>{pointLight({12, 4, 0}, {8, 4, 2})};
    auto lights = chooseLights({}, atlas, scene, pose);
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_EQ(lights[0].position, glm::vec4(1, 2, 0, 0));
    EXPECT_EQ(lights[0].intensity, glm::vec4(2, 1, 0.5, 0)); // a quarter: distances have halved
    lights = chooseLights({{glm::dvec3(10, 6, 0), std::nullopt}, {glm::dvec3(10, 0, 8), glm::vec3(4)}}, atlas,
                          scene, pose);
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_NEAR(facingRadiance(lights[0], glm::dvec3(0)), 0.9, 1e-6);
    EXPECT_EQ(lights[1].intensity, glm::vec4(1, 1, 1, 0));
}

TEST(Lights, OfEveryKindLookTheSameAtAnyScale) {
    Atlas atlas = atlasWithScale(4.0f);
    std::vector<Light> world;
    for (std::uint32_t kind = 0; kind < kLightKindCount; ++kind) {
        Light light{};
        light.kind.x = kind;
        light.position = glm::vec4(12, 1, 0, kind == kLightSphere ? 0.5f : 0.0f);
        light.intensity = glm::vec4(2, 1, 3, 0);
        light.direction = glm::vec4(0, -1, 0, 0.5f);
        light.edgeU = glm::vec4(1, 0, 0, 0.75f);
        light.edgeV = glm::vec4(0, 0, 2, 0);
        world.push_back(light);
    }
    atlas.lights = std::vector<Light>(world);
    const BoundsD scene{glm::dvec3(9, -1, -1), glm::dvec3(11, 1, 1)};
    const auto lights = chooseLights({}, atlas, scene, placeCamera({}, scene, 1.0));
    ASSERT_EQ(lights.size(), kLightKindCount);
    for (const Light& light : lights) {
        const bool fallsOff = light.kind.x == kLightPoint || light.kind.x == kLightSpot;
        EXPECT_EQ(glm::vec3(light.position), glm::vec3(8, 4, 0));
        EXPECT_EQ(light.position.w, light.kind.x == kLightSphere ? 2.0f : 0.0f);
        EXPECT_EQ(light.intensity, glm::vec4(2, 1, 3, 0) * (fallsOff ? 16.0f : 1.0f));
        EXPECT_EQ(light.direction, glm::vec4(0, -1, 0, 0.5f));
        EXPECT_EQ(light.edgeU, glm::vec4(4, 0, 0, 0.75f));
        EXPECT_EQ(light.edgeV, glm::vec4(0, 0, 8, 0));
    }
}

TEST(Lights, ACameraInsideTheSceneCarriesThem) {
    const BoundsD room{glm::dvec3(-5), glm::dvec3(5)};
    CameraRequest request;
    request.eye = glm::dvec3(1, 2, 3);
    for (const Light& light : chooseLights({}, atlasWithScale(1.0f), room, placeCamera(request, room, 1.0)))
        EXPECT_LT(glm::distance(glm::dvec3(light.position) + glm::dvec3(10, 0, 0), *request.eye), 1.0);
}

} // namespace
} // namespace rt
