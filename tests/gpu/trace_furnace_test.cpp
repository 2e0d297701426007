// Rough surfaces and the environment: what must come out, whatever the sampling does.
#include "tests/gpu/scene_fixture.h"

#include <glm/trigonometric.hpp>

#include <iostream>

namespace rt {
namespace {

using test::isNear;
using test::makeFloor;
using test::SceneOnGpu;
using test::SceneSettings;

constexpr double kPi = 3.14159265358979323846;

// Density of facets' normals (Trowbridge & Reitz 1975) and how much of them is seen (Smith 1967), after
// Heitz 2014, with the tangent of the angle.
double facets(double alpha, const glm::dvec3& h) {
    if (h.z <= 0.0) return 0.0;
    const double tangent2 = (h.x * h.x + h.y * h.y) / (h.z * h.z), a2 = alpha * alpha;
    return 1.0 / (kPi * a2 * std::pow(h.z, 4.0) * std::pow(1.0 + tangent2 / a2, 2.0));
}
double hidden(double alpha, const glm::dvec3& w) {
    const double tangent = std::sqrt(w.x * w.x + w.y * w.y) / w.z;
    return 0.5 * (std::sqrt(1.0 + std::pow(alpha * tangent, 2.0)) - 1.0);
}
/// BRDF times the light's cosine, of metal that reflects all.
double lobe(double alpha, const glm::dvec3& view, const glm::dvec3& light) {
    if (view.z <= 0.0 || light.z <= 0.0) return 0.0;
    const glm::dvec3 h = glm::normalize(view + light);
    return facets(alpha, h) / (1.0 + hidden(alpha, view) + hidden(alpha, light)) / (4.0 * view.z);
}

/// Integral of lobe * radiance(direction) by the midpoint rule over half vectors' angles, which follow the
/// lobe: h = (sin t cos p, sin t sin p, cos t), dw_light = 4 (view . h) dw_h.
template <class Radiance>
double reflected(double alpha, const glm::dvec3& view, const Radiance& radiance) {
    constexpr int kPolar = 1000, kAround = 200;
    double sum = 0.0;
    for (int i = 0; i < kPolar; ++i) {
        // tan t = alpha s / (1 - s): fine where the lobe is.
        const double s = (i + 0.5) / kPolar, tangent = alpha * s / (1.0 - s);
        const double polar = std::atan(tangent);
        const double width = alpha / ((1.0 - s) * (1.0 - s)) / (1.0 + tangent * tangent) / kPolar;
        for (int j = 0; j < kAround; ++j) {
            const double around = 2.0 * kPi * (j + 0.5) / kAround;
            const glm::dvec3 h(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                               std::cos(polar));
            const double cosine = glm::dot(view, h);
            if (cosine <= 0.0) continue;
            const glm::dvec3 light = 2.0 * cosine * h - view;
            const double value = lobe(alpha, view, light);
            if (value > 0.0)
                sum +=
                    value * radiance(light) * 4.0 * cosine * std::sin(polar) * width * (2.0 * kPi / kAround);
        }
    }
    return sum;
}

Mesh withMaterial(Mesh mesh, const Material& material) {
    mesh.materials = std::vector<Material>{material};
    return mesh;
}
// Each triangle with its own flat normals.
Mesh flat(const Mesh& mesh) {
    std::vector<glm::vec3> corners;
    for (const glm::uvec3& t : mesh.triangles)
        for (const std::uint32_t corner : {t.x, t.y, t.z}) corners.push_back(mesh.positions[corner]);
    return test::makeTriangles(corners);
}

class Furnace : public test::OnGpu {
protected:
    static SceneSettings inFurnace() {
        SceneSettings settings;
        settings.environment = test::evenEnvironment(glm::vec3(1.0f));
        settings.multisample = true;
        return settings;
    }
    static test::Shot portrait(unsigned samples) {
        test::Shot shot;
        shot.pose = {{0, 0, 4}, {0, 0, 0}, {0, 1, 0}};
        shot.pose.fovDegrees = 32.0;
        shot.size = glm::uvec2(24);
        shot.samples = samples;
        shot.filterRadius = 0.5f;
        return shot;
    }
    static glm::dvec3 viewAt(double degrees) {
        return {std::sin(glm::radians(degrees)), 0, std::cos(glm::radians(degrees))};
    }
};

TEST_F(Furnace, AWhiteDiffuseSphereIsNotSeen) {
    for (const bool smooth : {false, true}) {
        const Mesh sphere = smooth ? test::makeSphere(5) : flat(test::makeSphere(3));
        const SceneOnGpu scene(*context, withMaterial(sphere, test::matt(1.0f)), inFurnace());
        const FilmPixels pixels = scene.render(portrait(256));
        double sum = 0.0, worst = 0.0;
        for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
            const double off = pixels.colors[i].y - 1.0;
            sum += off;
            // Triangles of a smooth sphere hide a little of what its normals see.
            const double error = std::sqrt(double(pixels.variances[i]));
            worst = std::max(worst, std::abs(off) / (5.0 * error + (smooth ? 0.01 : 1e-4)));
        }
        EXPECT_LT(worst, 1.0);
        EXPECT_NEAR(sum / double(pixels.colors.size()), 0.0, 1e-3) << (smooth ? "smooth" : "flat");
    }
}

// One bounce between facets is all there is: the rest of it is lost. How much is a matter of integrals.
TEST_F(Furnace, WhiteRoughMetalLosesWhatItsFacetsHide) {
    for (const double roughness : {0.1, 0.3, 0.6, 1.0}) {
        const double alpha = roughness * roughness;
        const SceneOnGpu scene(
            *context,
            withMaterial(makeFloor({-4, -4}, {4, 4}, 0), test::metal(glm::vec3(1), float(roughness))),
            inFurnace());
        for (const double degrees : {0.0, 45.0, 80.0}) {
            const double expected = reflected(alpha, viewAt(degrees), [](const glm::dvec3&) { return 1.0; });
            const test::Estimate found = scene.estimate(viewAt(degrees), {0, 0, 0}, 4096);
            EXPECT_NEAR(found.color.y, expected, 3e-3) << roughness << " at " << degrees << " degrees";
            std::cout << "white metal, roughness " << roughness << ", " << degrees << " degrees: loses "
                      << 100.0 * (1.0 - found.color.y) << " % (by quadrature " << 100.0 * (1.0 - expected)
                      << " %)\n";
        }
    }
}

TEST_F(Furnace, AGlassBallIsNotSeen) {
    SceneSettings settings = inFurnace();
    settings.maxDepth = 16;
    const SceneOnGpu scene(*context, withMaterial(test::makeSphere(4), test::glass(1.5f)), settings);
    const FilmPixels pixels = scene.render(portrait(64));
    double sum = 0.0;
    for (const glm::vec4& color : pixels.colors) {
        sum += color.y;
        EXPECT_NEAR(color.y, 1.0f, 0.1f);
    }
    EXPECT_NEAR(sum / double(pixels.colors.size()), 1.0, 3e-3);
}

// A lobe seen by the light of a point: nothing but the formula.
TEST_F(Furnace, HighlightsOfPointLightsAreTheLobe) {
    const glm::dvec3 place(0.6, 0.2, 1.4);
    SceneSettings settings;
    settings.lights = {pointLight(place, glm::vec3(10.0f))};
    for (const double roughness : {0.03, 0.05, 0.1, 0.3, 0.7}) {
        const double alpha = roughness * roughness;
        const SceneOnGpu scene(
            *context,
            withMaterial(makeFloor({-4, -4}, {4, 4}, 0), test::metal(glm::vec3(1), float(roughness))),
            settings);
        const glm::dvec3 toLight = glm::normalize(place);
        const glm::dvec3 mirrored(-toLight.x, -toLight.y, toLight.z);
        for (const double beside : {0.0, 0.3, 1.0, 3.0}) { // half vectors turned by so many alphas
            const glm::dvec3 view = glm::normalize(mirrored + glm::dvec3(0, 2.0 * alpha * beside, 0));
            const double expected = 10.0 / glm::dot(place, place) * lobe(alpha, view, toLight);
            EXPECT_TRUE(isNear(scene.radiance(view * 2.0, {0, 0, 0}), glm::dvec3(expected), 5e-3))
                << "roughness " << roughness << ", " << beside << " alphas from the peak";
        }
    }
}

// Both ways of finding a light with a size, by choosing points on it and by reflected rays, add up.
TEST_F(Furnace, LightsWithASizeAreReflectedByRoughMetal) {
    const glm::dvec3 centre(-0.5, 0.2, 1.5);
    const double radius = 0.4;
    Light sphere = pointLight(centre, glm::vec3(1.0f));
    sphere.kind.x = kLightSphere;
    sphere.position.w = float(radius);
    SceneSettings settings;
    settings.lights = {sphere};
    settings.multisample = true;
    const double inside = std::sqrt(1.0 - radius * radius / glm::dot(centre, centre));
    const auto radiance = [&](const glm::dvec3& direction) {
        return glm::dot(direction, glm::normalize(centre)) > inside ? 1.0 : 0.0;
    };
    for (const double roughness : {0.1, 0.4, 0.9}) {
        const double alpha = roughness * roughness;
        const SceneOnGpu scene(
            *context,
            withMaterial(makeFloor({-4, -4}, {4, 4}, 0), test::metal(glm::vec3(1), float(roughness))),
            settings);
        for (const double degrees : {5.0, 30.0, 60.0}) {
            const double expected = reflected(alpha, viewAt(degrees), radiance);
            const double found = scene.estimate(viewAt(degrees), {0, 0, 0}, 4096).color.y;
            EXPECT_NEAR(found, expected, 4e-3) << roughness << " at " << degrees << " degrees";
        }
    }
}

// 0.6 x 0.8, facing down.
Light rectangleAt(const glm::vec3& centre) {
    Light light = pointLight(centre, glm::vec3(1.0f));
    light.kind.x = kLightRectangle;
    light.direction = glm::vec4(0, 0, -1, 0);
    light.edgeU = glm::vec4(0.3f, 0, 0, 0);
    light.edgeV = glm::vec4(0, 0.4f, 0, 0);
    return light;
}

// The same, where each way leads through something clear. The index is low: light that the pane sends back to
// the metal is not in the integral.
TEST_F(Furnace, LightsWithASizeAreReflectedOnceBehindWhatIsClear) {
    constexpr double kOpacity = 0.4, kIndex = 1.15, kRadius = 0.4, kAlpha = 0.09;
    const glm::dvec3 centre(-0.5, 0.2, 1.5);
    Light sphere = pointLight(centre, glm::vec3(1.0f));
    sphere.kind.x = kLightSphere;
    sphere.position.w = float(kRadius);
    const Light rectangle = rectangleAt(centre);
    Material veil = diffuseMaterial(glm::vec3(0.0f));
    veil.baseColor.a = float(kOpacity);
    veil.more.y = kMaterialClear;
    Material pane = test::glass(float(kIndex));
    pane.more.y = kMaterialThin;
    const double inside = std::sqrt(1.0 - kRadius * kRadius / glm::dot(centre, centre));
    for (const bool isVeil : {true, false})
        for (const bool isSphere : {true, false}) {
            SceneSettings settings;
            settings.lights = {isSphere ? sphere : rectangle};
            settings.multisample = true;
            const SceneOnGpu scene(
                *context,
                test::joinedParts({{makeFloor({-4, -4}, {4, 4}, 0), test::metal(glm::vec3(1), 0.3f)},
                                   {makeFloor({-4, -4}, {4, 4}, 0.8f), isVeil ? veil : pane}}),
                settings);
            const auto radiance = [&](const glm::dvec3& d) {
                const glm::dvec3 at = d * (centre.z / d.z) - centre;
                const bool lit = isSphere ? glm::dot(d, glm::normalize(centre)) > inside
                                          : std::abs(at.x) < 0.3 && std::abs(at.y) < 0.4;
                const double once = test::fresnel(std::acos(d.z), 1.0, kIndex);
                return !lit ? 0.0 : isVeil ? 1.0 - kOpacity : (1.0 - once) / (1.0 + once);
            };
            for (const double degrees : {10.0, 30.0}) {
                const double expected = reflected(kAlpha, viewAt(degrees), radiance);
                const double found = scene.estimate(viewAt(degrees) * 0.7, {0, 0, 0}, 4096).color.y;
                EXPECT_NEAR(found, expected, 0.015 * expected + 5e-4)
                    << (isVeil ? "veil" : "pane") << (isSphere ? ", sphere" : ", rectangle") << " at "
                    << degrees;
            }
        }
}

EnvironmentMap patchyEnvironment() {
    EnvironmentMap map{8, 4, {}, {}};
    for (unsigned i = 0; i < 32; ++i)
        map.pixels.emplace_back(0.05f * float(i % 5), i == 11 ? 6.0f : 0.1f * float(i % 3),
                                i == 20 ? 3.0f : 0.02f);
    map.cdf = environmentCdf(map.width, map.height, map.pixels);
    return map;
}

TEST_F(Furnace, TheEnvironmentIsSeenWhereItIs) {
    SceneSettings settings;
    settings.environment = patchyEnvironment();
    settings.view = kPanoramaView;
    const SceneOnGpu scene(*context, makeFloor({5, 5}, {5.01f, 5.01f}, 5), settings);
    for (const double turn : {0.0, 0.1875}) {
        test::Shot shot;
        shot.pose = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}};
        shot.pose.view = kPanoramaView;
        shot.size = {32, 16}; // four rays across each pixel of the environment
        shot.environmentTurn = float(turn);
        const FilmPixels pixels = scene.render(shot);
        for (unsigned i = 0; i < 32 * 16; ++i) {
            const double longitude = 2.0 * kPi * ((i % 32 + 0.5) / 32 - 0.5),
                         polar = kPi * (i / 32 + 0.5) / 16;
            const glm::dvec3 direction(std::sin(polar) * std::sin(longitude), std::cos(polar),
                                       -std::sin(polar) * std::cos(longitude));
            EXPECT_TRUE(isNear(glm::dvec3(glm::vec3(pixels.colors[i])),
                               test::skyOf(settings.environment, direction, turn), 3e-3))
                << i;
        }
    }
}

// Diffuse and rough surfaces under it, by quadrature.
TEST_F(Furnace, TheEnvironmentLightsDiffuseAndRoughSurfaces) {
    SceneSettings settings;
    settings.environment = patchyEnvironment();
    settings.multisample = true;
    const auto light = [&](const glm::dvec3& d) { return test::skyOf(settings.environment, d, 0.0); };
    glm::dvec3 irradiance(0);
    constexpr int kSide = 2000;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) { // cosine-weighted: equal areas of the unit disc
            const double r = std::sqrt((i + 0.5) / kSide), p = 2.0 * kPi * (j + 0.5) / kSide;
            irradiance +=
                light({r * std::cos(p), r * std::sin(p), std::sqrt(1.0 - r * r)}) * (kPi / kSide / kSide);
        }
    const SceneOnGpu diffuse(*context, makeFloor({-4, -4}, {4, 4}, 0), settings);
    EXPECT_TRUE(
        isNear(diffuse.estimate({0, 0, 2}, {0, 0, 0}, 1u << 14).color, irradiance * (0.8 / kPi), 4e-3));
    for (const double roughness : {0.2, 0.5}) {
        const SceneOnGpu rough(
            *context,
            withMaterial(makeFloor({-4, -4}, {4, 4}, 0), test::metal(glm::vec3(1), float(roughness))),
            settings);
        for (const double degrees : {10.0, 50.0}) {
            glm::dvec3 expected;
            for (int c = 0; c < 3; ++c)
                expected[c] = reflected(roughness * roughness, viewAt(degrees),
                                        [&](const glm::dvec3& d) { return light(d)[c]; });
            EXPECT_TRUE(isNear(rough.estimate(viewAt(degrees), {0, 0, 0}, 1u << 14).color, expected, 6e-3))
                << roughness << " at " << degrees << " degrees";
        }
    }
}

} // namespace
} // namespace rt
