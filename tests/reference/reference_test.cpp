// Whole pictures against a renderer that shares nothing with the shaders but the surface model.
#include "formats/mesh_file.h"
#include "tests/gpu/scene_fixture.h"
#include "tests/reference/renderer.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>

#include <filesystem>

namespace rt {
namespace {

constexpr glm::uvec2 kSize(64, 48);

Light rectangle(const glm::vec3& centre, const glm::vec3& u, const glm::vec3& v, const glm::vec3& radiance) {
    Light light = pointLight(centre, radiance);
    light.kind.x = kLightRectangle;
    light.edgeU = glm::vec4(u, 0.0f);
    light.edgeV = glm::vec4(v, 0.0f);
    light.direction = glm::vec4(glm::normalize(glm::cross(u, v)), 0.0f);
    return light;
}

struct MatchedScene {
    const char* name;
    Mesh mesh;
    CameraPose pose;
    test::SceneSettings settings;
    unsigned samples = 192, referenceSamples = 512;
};

struct Comparison {
    std::size_t beyond = 0; ///< pixels off by more than 4 sigma + 1 %
    glm::dvec3 meanFound{0.0}, meanExpected{0.0};
    double meanError = 0.0; ///< standard error of the difference of the means, of the luminance
    double worst = 0.0;     ///< off / (4 sigma + 1 %)
    std::size_t worstPixel = 0;
};

double luminanceOf(const glm::dvec3& color) {
    return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722));
}

Comparison compare(const FilmPixels& found, const std::vector<reference::Pixel>& expected) {
    Comparison result;
    double squares = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const glm::dvec3 color(glm::vec3(found.colors[i]));
        const double error2 = double(found.variances[i]) + expected[i].error * expected[i].error;
        const double allowed = 4.0 * std::sqrt(error2) + 0.01 * expected[i].luminance + 1e-6;
        const double off = std::abs(luminanceOf(color) - expected[i].luminance) / allowed;
        result.beyond += off > 1.0;
        if (off > result.worst) {
            result.worst = off;
            result.worstPixel = i;
        }
        squares += error2;
        result.meanFound += color / double(expected.size());
        result.meanExpected += expected[i].mean / double(expected.size());
    }
    result.meanError = std::sqrt(squares) / double(expected.size());
    return result;
}

class Reference : public test::OnGpu {
protected:
    static void expectMatch(const MatchedScene& scene) {
        test::Shot shot;
        shot.pose = scene.pose;
        shot.size = kSize;
        shot.samples = scene.samples;
        shot.filterRadius = 0.5f;
        const FilmPixels found = test::SceneOnGpu(*context, scene.mesh, scene.settings).render(shot);
        reference::Settings settings;
        settings.pose = scene.pose;
        settings.size = kSize;
        settings.samples = scene.referenceSamples;
        settings.maxDepth = scene.settings.maxDepth;
        settings.lights = scene.settings.lights;
        settings.skyLights = !scene.settings.environment.pixels.empty();
        if (settings.skyLights)
            settings.sky = [&](const glm::dvec3& d) { return test::skyOf(scene.settings.environment, d); };
        expectSame(scene.name, compare(found, reference::render(scene.mesh, settings)));
    }

private:
    static void expectSame(const char* name, const Comparison& c) {
        const double mean = luminanceOf(c.meanExpected), off = luminanceOf(c.meanFound) / mean - 1.0;
        fmt::print("{}: mean off by {:.3f} % (one sigma {:.3f} %), {} of {} pixels off by more than 4 sigma "
                   "+ 1 %, the "
                   "worst by {:.2f} of that at {}, {}\n",
                   name, 100.0 * off, 100.0 * c.meanError / mean, c.beyond, kSize.x * kSize.y, c.worst,
                   c.worstPixel % kSize.x, c.worstPixel / kSize.x);
        EXPECT_LE(c.beyond, kSize.x * kSize.y / 1000);
        EXPECT_LT(c.meanError / mean, 2e-3) << "too much noise to tell";
        EXPECT_LT(std::abs(off), 3e-3 + 2.0 * c.meanError / mean);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(c.meanFound[k] / c.meanExpected[k], 1.0, 8e-3) << "channel " << k;
    }
};

Mesh importedMesh(const std::string& path) {
    const test::TemporaryFolder folder;
    const auto result = test::runCommand({RT_BIN_DIR "/rt-import", path, "-o", folder.file("m.rtmesh")});
    if (result.exitCode != 0) throw std::runtime_error(result.err);
    return readMesh(folder.file("m.rtmesh")).mesh; // stays mapped
}

// The lamp is a rectangle in the plane of a triangle pair that glows as it does.
TEST_F(Reference, TheCornellBoxUnderARectangleOfLight) {
    const std::string path = test::scenePath("models/interior/cornell_box.obj");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    MatchedScene scene{"Cornell box", importedMesh(path), {}, {}};
    scene.pose = {
        {0, 1, 3.2}, {0, 0.8, 0}, {0, 1, 0}}; // below the lamp, which is much brighter than what it lights
    scene.pose.fovDegrees = 34.0;
    scene.settings.multisample = true;
    scene.settings.lights = {
        rectangle({-0.005f, 1.98f, -0.03f}, {0.235f, 0, 0}, {0, 0, 0.19f}, {36, 33, 24})};
    expectMatch(scene);
}

Material rough(Material material, float roughness) {
    material.reflection.y = roughness;
    return material;
}

Mesh ball(const glm::vec3& centre, float radius) {
    return test::moved(test::makeSphere(4), radius, centre);
}

// A coloured glass ball that holds a bubble of water, a smooth ball of gold, a mirror that is half grey, a
// thin pane, a veil.
TEST_F(Reference, GlassAndMetalUnderASphereAndASpot) {
    Material colored = test::glass(1.5f, {0.95f, 0.9f, 0.95f});
    colored.transmission.z = 0.5f;
    colored.attenuation = glm::vec4(0.4f, 0.8f, 0.6f, 1.0f);
    Material pane = test::glass(1.5f, {0.9f, 0.95f, 0.8f});
    pane.more.y = kMaterialThin;
    Material veil = diffuseMaterial({0.6f, 0.3f, 0.2f});
    veil.baseColor.a = 0.6f;
    veil.more.y = kMaterialClear;
    Material halfMirror = diffuseMaterial({0.5f, 0.5f, 0.6f});
    halfMirror.reflection = glm::vec4(0, 0, 1, 0.5f);
    halfMirror.transmission.y = 1.6f;
    MatchedScene scene{
        "glass and metal",
        test::joinedParts({{test::makeFloor({-3, -3}, {3, 3}, 0), test::matt(0.6f)},
                           {ball({-0.9f, -0.2f, 0.7f}, 0.7f), colored},
                           {ball({-0.9f, -0.2f, 0.7f}, 0.35f), test::glass(1.33f)},
                           {ball({0.8f, 0.5f, 0.6f}, 0.6f), test::metal({0.95f, 0.7f, 0.3f}, 0.0f)},
                           {test::makeBox({-0.2f, 1.1f, 0}, {0.3f, 1.5f, 1.8f}), halfMirror},
                           {test::makeBox({0.3f, -1.2f, 0.02f}, {1.2f, -1.1f, 0.8f}), pane},
                           {test::makeFloor({-2.4f, -0.6f}, {-1.2f, 1.6f}, 1.6f), veil}}),
        {},
        {}};
    Light sphere = pointLight({-0.5f, -1.0f, 3.0f}, glm::vec3(3.5f, 3.2f, 2.8f));
    sphere.kind.x = kLightSphere;
    sphere.position.w = 0.7f;
    Light spot = pointLight({2.0f, -1.5f, 2.5f}, glm::vec3(6, 7, 9));
    spot.kind.x = kLightSpot;
    spot.direction = glm::vec4(glm::normalize(glm::vec3(-1.6f, 1.5f, -2.2f)), 0.8f);
    spot.edgeU.w = 0.95f;
    scene.settings.lights = {sphere, spot};
    scene.samples = 256;
    scene.referenceSamples = 1024;
    scene.settings.multisample = true;
    scene.pose = {{0.4, -4.5, 2.2}, {0, 0, 0.6}, {0, 0, 1}};
    expectMatch(scene);
}

EnvironmentMap makeSky() {
    EnvironmentMap map{32, 16, {}, {}};
    for (unsigned i = 0; i < 32 * 16; ++i) {
        const double u = (i % 32 + 0.5) / 32, v = (i / 32 + 0.5) / 16;
        const double sun = 12.0 * std::exp(-40.0 * ((u - 0.3) * (u - 0.3) + (v - 0.25) * (v - 0.25)));
        map.pixels.emplace_back(0.3 + 0.9 * sun, 0.4 + 0.8 * sun, 0.9 - 0.8 * v + 0.6 * sun);
    }
    map.cdf = environmentCdf(map.width, map.height, map.pixels);
    return map;
}

// Balls from polished to matt, of metal, lacquer and frosted glass.
TEST_F(Reference, RoughBallsUnderAnEnvironmentAndARectangle) {
    std::vector<test::Part> parts = {
        {test::makeFloor({-4, -4}, {4, 4}, -0.5f), rough(test::metal({0.5f, 0.5f, 0.55f}, 0), 0.6f)}};
    for (int i = 0; i < 4; ++i) {
        const float x = float(i) - 1.5f, roughness = 0.15f + 0.25f * float(i);
        Material lacquer = rough(diffuseMaterial({0.7f, 0.2f, 0.15f}), roughness);
        lacquer.reflection.z = 1.0f;
        lacquer.transmission.y = 1.5f;
        parts.push_back({ball({x, 0, 1.1f}, 0.42f), rough(test::metal({0.95f, 0.8f, 0.5f}, 0), roughness)});
        parts.push_back({ball({x, 0, 0}, 0.42f), lacquer});
    }
    parts.push_back({ball({0, -1.2f, 0.2f}, 0.4f), rough(test::glass(1.5f), 0.4f)});
    MatchedScene scene{"rough balls", test::joinedParts(parts), {}, {}};
    scene.settings.environment = makeSky();
    scene.settings.multisample = true;
    scene.settings.lights = {rectangle({0, -2.5f, 2.2f}, {1, 0, 0}, {0, -0.4f, -0.4f}, glm::vec3(5))};
    scene.pose = {{0.2, -5, 1.6}, {0, 0, 0.35}, {0, 0, 1}};
    expectMatch(scene);
}

} // namespace
} // namespace rt
