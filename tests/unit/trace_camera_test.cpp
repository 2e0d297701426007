// The default camera and lights of rt-trace.
#include "common/error.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/lights.h"

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

TEST(Lights, ACameraInsideTheSceneCarriesThem) {
    const BoundsD room{glm::dvec3(-5), glm::dvec3(5)};
    CameraRequest request;
    request.eye = glm::dvec3(1, 2, 3);
    for (const Light& light : chooseLights({}, atlasWithScale(1.0f), room, placeCamera(request, room, 1.0)))
        EXPECT_LT(glm::distance(glm::dvec3(light.position) + glm::dvec3(10, 0, 0), *request.eye), 1.0);
}

} // namespace
} // namespace rt
