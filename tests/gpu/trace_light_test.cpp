// Lights of all kinds, shadows and the environment against closed forms.
#include "tests/gpu/scene_fixture.h"
#include "tools/rt-trace/parse_light.h"

#include <glm/trigonometric.hpp>

namespace rt {
namespace {

using test::isNear;
using test::SceneOnGpu;
using test::SceneSettings;

constexpr double kPi = 3.14159265358979323846;
constexpr double kAlbedo = 0.8;
constexpr double kExact = 2e-5;   // of one sample: what floats leave
constexpr double kSampled = 1e-3; // of kManySamples
constexpr unsigned kManySamples = 4096;

class Lighting : public test::OnGpu {
protected:
    static SceneOnGpu floorUnder(const Light& light, bool multisample = false) {
        SceneSettings settings;
        settings.lights = {light};
        settings.multisample = multisample;
        return {*context, test::makeFloor({-4, -4}, {4, 4}, 0.0f), settings};
    }
    // From a little above, so that no light is in the way.
    static glm::dvec3 seen(const SceneOnGpu& scene, const glm::dvec3& point, unsigned samples = 1) {
        return scene.estimate(point + glm::dvec3(0.3, -0.2, 0.4), point, samples).color;
    }
};

const glm::dvec3 kPoints[] = {{0, 0, 0}, {1, 0, 0}, {-0.5, 2, 0}, {3, -3, 0}};
const glm::dvec3 kColor(3.0, 2.0, 1.0);

TEST_F(Lighting, APointLightFallsWithTheSquareOfItsDistance) {
    const glm::dvec3 place(0.25, -0.5, 2.0);
    const SceneOnGpu scene = floorUnder(pointLight(place, kColor));
    for (const glm::dvec3& point : kPoints) {
        const glm::dvec3 way = place - point;
        const double cosine = way.z / glm::length(way);
        EXPECT_TRUE(
            isNear(seen(scene, point), kColor * (kAlbedo / kPi * cosine / glm::dot(way, way)), kExact));
    }
}

TEST_F(Lighting, ADirectionalLightIsTheSameEverywhere) {
    Light light = pointLight({}, kColor);
    light.kind.x = kLightDirectional;
    light.direction = glm::vec4(glm::normalize(glm::vec3(0.5f, 0.3f, -1.0f)), 0.0f);
    const SceneOnGpu scene = floorUnder(light);
    for (const glm::dvec3& point : kPoints)
        EXPECT_TRUE(
            isNear(seen(scene, point), kColor * (kAlbedo / kPi * -double(light.direction.z)), kExact));
}

// Between the half angles the intensity is the square of a line in the angle's cosine (KHR_lights_punctual).
TEST_F(Lighting, ASpotFadesBetweenItsTwoAngles) {
    const double inner = glm::radians(20.0), outer = glm::radians(35.0);
    Light light = pointLight({0, 0, 2}, kColor);
    light.kind.x = kLightSpot;
    light.direction = glm::vec4(0, 0, -1, std::cos(outer));
    light.edgeU.w = static_cast<float>(std::cos(inner));
    const SceneOnGpu scene = floorUnder(light);
    for (const double degrees : {0.0, 10.0, 19.9, 21.0, 27.0, 34.0, 34.9, 35.1, 50.0}) {
        const double angle = glm::radians(degrees), cosine = std::cos(angle);
        const double part = (cosine - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
        const double fading = part <= 0.0 ? 0.0 : part >= 1.0 ? 1.0 : part * part;
        const double distance = 2.0 / cosine;
        EXPECT_TRUE(isNear(seen(scene, {2.0 * std::tan(angle), 0, 0}),
                           kColor * (fading * kAlbedo / kPi * cosine / (distance * distance)), 5e-4))
            << degrees << " degrees";
    }
}

// Lights of the command line that say no colour: a surface that faces them from the scene's centre gets the
// same from each.
TEST_F(Lighting, TheUsualIntensityIsThatOfAWhiteSurfaceAtTheScenesCentre) {
    Atlas world;
    world.grid.worldOffset = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
    const BoundsD bounds{{-4, -4, 0}, {4, 4, 0}};
    for (const char* const text : {"0,0,5", "directional:0,0,-2", "spot:0,0,5,0,0,0,20,10",
                                   "rectangle:0,0,5,0,0,0,0.1,0.05", "sphere:0,0,5,2"}) {
        const std::vector<Light> lights = chooseLights({parseLight(text)}, world, bounds, {});
        ASSERT_EQ(lights.size(), 1u);
        const bool sized = lights[0].kind.x == kLightRectangle || lights[0].kind.x == kLightSphere;
        const SceneOnGpu scene = floorUnder(lights[0], sized);
        EXPECT_TRUE(isNear(seen(scene, {0, 0, 0}, sized ? kManySamples : 1), glm::dvec3(0.9 * kAlbedo),
                           sized ? kSampled : kExact))
            << text;
    }
}

// Of a rectangle parallel to the surface, with a corner above the point (Howell, configuration B-3).
double cornerFactor(double a, double b, double height) {
    const double x = a / height, y = b / height;
    const double u = std::sqrt(1.0 + x * x), v = std::sqrt(1.0 + y * y);
    return (x / u * std::atan(y / u) + y / v * std::atan(x / v)) / (2.0 * kPi);
}

double rectangleFactor(glm::dvec2 lo, glm::dvec2 hi, double height) {
    return cornerFactor(hi.x, hi.y, height) - cornerFactor(lo.x, hi.y, height) -
           cornerFactor(hi.x, lo.y, height) + cornerFactor(lo.x, lo.y, height);
}

Light rectangleAbove(const glm::vec3& centre, float halfX, float halfY) {
    Light light = pointLight(centre, kColor);
    light.kind.x = kLightRectangle;
    light.direction = glm::vec4(0, 0, -1, 0);
    light.edgeU = glm::vec4(halfX, 0, 0, 0);
    light.edgeV = glm::vec4(0, halfY, 0, 0);
    return light;
}

TEST_F(Lighting, ARectangleLightsAPlaneByItsFormFactor) {
    const glm::dvec2 centre(0.5, 0.25), half(1.0, 0.75);
    const double height = 1.5;
    const SceneOnGpu scene = floorUnder(rectangleAbove({centre, height}, float(half.x), float(half.y)), true);
    for (const glm::dvec3& point : kPoints) {
        const glm::dvec2 lo = centre - half - glm::dvec2(point), hi = centre + half - glm::dvec2(point);
        EXPECT_TRUE(isNear(seen(scene, point, kManySamples),
                           kColor * (kAlbedo * rectangleFactor(lo, hi, height)), kSampled));
    }
}

// Irradiance of a sphere that is all above the horizon: pi L (r / d)^2 cos, whatever its size.
TEST_F(Lighting, ASphereLightsAPlaneAsItsSolidAngleWeighedByTheCosineSays) {
    const glm::dvec3 centre(0.5, -0.25, 2.0);
    const double radius = 0.75;
    Light light = pointLight(centre, kColor);
    light.kind.x = kLightSphere;
    light.position.w = static_cast<float>(radius);
    const SceneOnGpu scene = floorUnder(light, true);
    for (const glm::dvec3& point : kPoints) {
        const glm::dvec3 way = centre - point;
        const double squared = glm::dot(way, way), cosine = way.z / std::sqrt(squared);
        EXPECT_TRUE(isNear(seen(scene, point, kManySamples),
                           kColor * (kAlbedo * radius * radius / squared * cosine), kSampled));
    }
}

// As lamps that are part of a ceiling are.
TEST_F(Lighting, ARectangleInThePlaneOfASurfaceIsSeenAndShines) {
    const glm::dvec2 half(0.7, 0.4);
    const double height = 1.7;
    for (const float tilt : {0.0f, 0.3f}) { // all of it turned about the x axis, so that numbers are rounded
        const glm::vec3 y(0, std::cos(tilt), std::sin(tilt)), z(0, -std::sin(tilt), std::cos(tilt));
        const auto turned = [&](Mesh mesh) {
            std::vector<glm::vec3> positions, normals;
            for (const glm::vec3& p : mesh.positions)
                positions.push_back(glm::vec3(p.x, 0, 0) + y * p.y + z * p.z);
            for (const glm::vec3& n : mesh.normals)
                normals.push_back(glm::vec3(n.x, 0, 0) + y * n.y + z * n.z);
            mesh.positions = std::move(positions);
            mesh.normals = std::move(normals);
            return mesh;
        };
        Light light = rectangleAbove(z * float(height), float(half.x), 0);
        light.direction = glm::vec4(-z, 0);
        light.edgeV = glm::vec4(y * float(half.y), 0);
        SceneSettings settings;
        settings.lights = {light};
        settings.multisample = true;
        const SceneOnGpu scene(
            *context,
            test::joinedParts({{turned(test::makeFloor({-4, -4}, {4, 4}, 0)), test::matt(float(kAlbedo))},
                               {turned(test::makeFloor({-4, -3}, {4, 4}, float(height))), test::matt(0.5f)}}),
            settings);
        for (const double x : {0.0, 0.5, 2.0}) {
            const glm::dvec3 point = glm::dvec3(x, 0, 0) + glm::dvec3(y) * 0.3;
            const glm::dvec2 lo(-half.x - x, -half.y - 0.3), hi(half.x - x, half.y - 0.3);
            EXPECT_TRUE(isNear(seen(scene, point, kManySamples),
                               kColor * (kAlbedo * rectangleFactor(lo, hi, height)), kSampled))
                << "tilt " << tilt << ", x " << x;
            const glm::dvec3 lamp = glm::dvec3(z) * height + glm::dvec3(0.6, 0, 0) - glm::dvec3(y) * 0.35;
            EXPECT_TRUE(isNear(scene.radiance(point + glm::dvec3(z) * 0.2, lamp), kColor, kExact));
        }
    }
}

TEST_F(Lighting, ARectangleIsSeenFromItsFrontOnlyASphereFromOutside) {
    const SceneOnGpu rectangle = floorUnder(rectangleAbove({0, 0, 2}, 0.5f, 0.25f));
    EXPECT_TRUE(isNear(rectangle.radiance({0, 0, 1}, {0.49, 0.24, 2}), kColor, kExact));
    EXPECT_TRUE(isNear(rectangle.radiance({0, 0, 1}, {0.51, 0.24, 2}), glm::dvec3(0), kExact));
    EXPECT_TRUE(isNear(rectangle.radiance({0, 0, 1}, {0.49, 0.26, 2}), glm::dvec3(0), kExact));
    const glm::dvec3 floor = seen(rectangle, {0.3, 0.3, 0});
    EXPECT_TRUE(isNear(rectangle.radiance({0, 0, 3}, {0.3, 0.3, 0}), floor, kExact)); // through its back
    Light light = pointLight({0, 0, 2}, kColor);
    light.kind.x = kLightSphere;
    light.position.w = 0.5f;
    const SceneOnGpu sphere = floorUnder(light);
    const double grazing = 0.5 / std::sqrt(0.75); // tangent from 1 below the centre: sine 0.5
    for (const double side : {-1.0, 1.0}) {
        EXPECT_TRUE(isNear(sphere.radiance({0, 0, 1}, {side * (grazing - 1e-3), 0, 2}), kColor, kExact));
        EXPECT_TRUE(
            isNear(sphere.radiance({0, 0, 1}, {side * (grazing + 1e-3), 0, 2}), glm::dvec3(0), kExact));
    }
}

} // namespace
} // namespace rt
