// What light goes through on its way to a surface, and rays on theirs: glass, opacity, cut-outs.
#include "tests/gpu/scene_fixture.h"

#include <glm/trigonometric.hpp>

namespace rt {
namespace {

using test::fresnel;
using test::glass;
using test::isNear;
using test::makeBox;
using test::makeFloor;
using test::matt;
using test::SceneOnGpu;

constexpr double kPi = 3.14159265358979323846;
constexpr double kAlbedo = 0.8;
constexpr double kExact = 5e-5;
constexpr float kIndex = 1.5f;
const glm::vec3 kIntensity(30.0f, 20.0f, 10.0f);

class Shadows : public test::OnGpu {
protected:
    // `blocker` lies between z = 1 and z = 2; the light is far off and shines down at an angle.
    static SceneOnGpu floorBehind(const test::Part& blocker, const std::vector<Light>& lights) {
        test::SceneSettings settings;
        settings.lights = lights;
        return {*context,
                test::joinedParts({{makeFloor({-4, -4}, {4, 4}, 0), matt(float(kAlbedo))}, blocker}),
                settings};
    }
    static Light sunAt(double angle) {
        Light light = pointLight({}, kIntensity);
        light.kind.x = kLightDirectional;
        light.direction = glm::vec4(float(std::sin(angle)), 0, float(-std::cos(angle)), 0);
        return light;
    }
    static glm::dvec3 seen(const SceneOnGpu& scene, const glm::dvec3& point) {
        return scene.radiance(point + glm::dvec3(0.3, -0.2, 0.4), point);
    }
    static glm::dvec3 unblocked(double angle) {
        return glm::dvec3(kIntensity) * (kAlbedo / kPi * std::cos(angle));
    }
};

// Straight through: the light that a pane lets through, without what goes back and forth in it.
TEST_F(Shadows, ASlabOfColouredGlassTintsLight) {
    constexpr double kThickness = 0.8;
    const glm::dvec3 surface(0.9, 0.8, 0.7), left(0.5, 0.7, 0.9);
    Material material = glass(kIndex, surface);
    material.transmission.z = 1.0f;
    material.attenuation = glm::vec4(left, 1.0f);
    for (const double degrees : {0.0, 30.0, 50.0, 70.0}) {
        const double angle = glm::radians(degrees), kept = 1.0 - fresnel(angle, 1.0, kIndex);
        const SceneOnGpu scene = floorBehind(
            {makeBox({-50, -50, 1}, {50, 50, float(1.0 + kThickness)}), material}, {sunAt(angle)});
        glm::dvec3 expected = unblocked(angle) * surface * surface * (kept * kept);
        for (int c = 0; c < 3; ++c) expected[c] *= std::pow(left[c], kThickness / std::cos(angle));
        EXPECT_TRUE(isNear(seen(scene, {0.5, 0.25, 0}), expected, kExact)) << degrees << " degrees";
    }
}

TEST_F(Shadows, AThinPaneTintsLightOnce) {
    const glm::dvec3 tint(0.9, 0.6, 0.3);
    Material material = glass(kIndex, tint);
    material.more.y = kMaterialThin;
    for (const double degrees : {0.0, 50.0, 75.0}) {
        const double angle = glm::radians(degrees), once = fresnel(angle, 1.0, kIndex);
        const SceneOnGpu scene = floorBehind({makeFloor({-50, -50}, {50, 50}, 1), material}, {sunAt(angle)});
        EXPECT_TRUE(isNear(seen(scene, {0.5, 0.25, 0}),
                           unblocked(angle) * tint * (1.0 - 2.0 * once / (1.0 + once)), kExact));
    }
}

TEST_F(Shadows, APointLightThroughGlassIsAsFarAsItIs) {
    const glm::dvec3 place(0.4, 0.3, 3.0), point(0.1, 0.2, 0.0);
    const SceneOnGpu scene =
        floorBehind({makeBox({-50, -50, 1}, {50, 50, 1.5}), glass(kIndex)}, {pointLight(place, kIntensity)});
    const glm::dvec3 way = place - point;
    const double cosine = way.z / glm::length(way), kept = 1.0 - fresnel(std::acos(cosine), 1.0, kIndex);
    EXPECT_TRUE(isNear(seen(scene, point),
                       glm::dvec3(kIntensity) * (kAlbedo / kPi * cosine / glm::dot(way, way) * kept * kept),
                       kExact));
}

Material clear(const glm::vec4& color, float cutoff) {
    Material material = diffuseMaterial(color);
    material.baseColor.a = color.a;
    material.transmission.w = cutoff;
    material.more.y = kMaterialClear;
    return material;
}

TEST_F(Shadows, WhatIsPartlyOpaqueStopsThatPartOfTheLight) {
    const double opacity = 0.3;
    const SceneOnGpu scene = floorBehind(
        {makeFloor({-50, -50}, {50, 50}, 1), clear({0.5f, 0.5f, 0.5f, float(opacity)}, 0.0f)}, {sunAt(0)});
    const glm::dvec3 behind = unblocked(0) * (1.0 - opacity);
    EXPECT_TRUE(isNear(seen(scene, {0.5, 0.25, 0}), behind, kExact));
    // From above: the veil's own light, and what comes through it.
    const glm::dvec3 veil = glm::dvec3(kIntensity) * (0.5 / kPi);
    EXPECT_TRUE(isNear(scene.radiance({0.5, 0.25, 3}, {0.5, 0.25, 0}),
                       veil * opacity + behind * (1.0 - opacity), kExact));
}

// An image of 2x1 texels, the left one clear; magnified, its opacity is a ramp between the texels' middles.
Mesh makePane(const Material& paneMaterial) {
    Mesh mesh = test::joinedParts({{makeFloor({-4, -4}, {4, 4}, 0), matt(float(kAlbedo))},
                                   {makeFloor({-2, -1}, {2, 1}, 1), paneMaterial}});
    std::vector<glm::vec2> texcoords;
    for (const glm::vec3& p : mesh.positions)
        texcoords.emplace_back((p.x + 2.0f) / 4.0f, (p.y + 1.0f) / 2.0f);
    mesh.texcoords = std::move(texcoords);
    mesh.images = std::vector<MeshImage>{{2, 1, kWrapClamp, kWrapClamp, 0}};
    mesh.pixels = std::vector<std::uint32_t>{0x00FFFFFFu, 0xFFFFFFFFu};
    return mesh;
}

TEST_F(Shadows, ACutOutLetsRaysAndLightThroughWhereItsImageIsClear) {
    Material material = clear({1, 1, 1, 1}, 0.5f);
    material.images.x = 0;
    test::SceneSettings settings;
    settings.lights = {sunAt(0)};
    const SceneOnGpu scene(*context, makePane(material), settings);
    const glm::dvec3 white = glm::dvec3(kIntensity) / kPi;
    for (const double x : {-1.9, -0.5, -0.01, 0.01, 0.5, 1.9}) {
        const bool isThere = x > 0.0;
        EXPECT_TRUE(isNear(scene.radiance({x, 0.3, 3}, {x, 0.3, 0}), isThere ? white : unblocked(0), kExact))
            << x;
        EXPECT_TRUE(isNear(scene.radiance({x, 0.3, 0.5}, {x, 0.3, 0}), isThere ? glm::dvec3(0) : unblocked(0),
                           kExact))
            << x;
    }
}

TEST_F(Shadows, OpacityFollowsTheImagesAlpha) {
    Material material = clear({1, 1, 1, 0.8f}, 0.0f);
    material.images.x = 0;
    test::SceneSettings settings;
    settings.lights = {sunAt(0)};
    const SceneOnGpu scene(*context, makePane(material), settings);
    const glm::dvec3 white = glm::dvec3(kIntensity) / kPi;
    for (const double x : {-1.5, -0.75, 0.0, 0.25, 1.5}) {
        const double opacity = 0.8 * std::clamp((x + 1.0) / 2.0, 0.0, 1.0), clear = 1.0 - opacity;
        EXPECT_TRUE(isNear(scene.radiance({x, 0.3, 0.5}, {x, 0.3, 0}), unblocked(0) * clear, 1e-4)) << x;
        EXPECT_TRUE(isNear(scene.radiance({x, 0.3, 3}, {x, 0.3, 0}),
                           white * opacity + unblocked(0) * (clear * clear), 1e-4))
            << x;
    }
}

// As decals are: colour that no light changes, over what is behind.
TEST_F(Shadows, WhatIsUnlitAndPartlyOpaqueShowsWhatIsBehind) {
    Material material = clear({0.9f, 0.5f, 0.1f, 0.25f}, 0.0f);
    material.more.y |= kMaterialUnlit;
    const SceneOnGpu scene = floorBehind({makeFloor({-50, -50}, {50, 50}, 1), material}, {sunAt(0)});
    EXPECT_TRUE(isNear(scene.radiance({0.5, 0.25, 3}, {0.5, 0.25, 0}),
                       glm::dvec3(0.9, 0.5, 0.1) * 0.25 + unblocked(0) * (0.75 * 0.75), kExact));
}

} // namespace
} // namespace rt
