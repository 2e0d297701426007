// Mirrors, metal and glass against Fresnel's equations, Snell's law and Beer's law.
#include "tests/gpu/scene_fixture.h"

#include <glm/exponential.hpp>
#include <glm/trigonometric.hpp>

namespace rt {
namespace {

using test::fresnel;
using test::glass;
using test::glowing;
using test::isNear;
using test::makeBox;
using test::makeFloor;
using test::SceneOnGpu;

constexpr float kIndex = 1.5f;
const glm::vec3 kGlow(0.9f, 0.2f, 0.4f);
const glm::vec3 kBackground(0.25f, 0.5f, 0.75f);
// Rays that count less than 1e-3 of the pixel are not traced where there is one sample.
constexpr double kUntraced = 2e-3;

class Glass : public test::OnGpu {
protected:
    /// From `height` above the origin's plane, down at an angle from the vertical, through (atX, 0.1, 0).
    static glm::dvec3 down(const SceneOnGpu& scene, double angle, double height, double atX = 0.0) {
        const glm::dvec3 at(atX, 0.1, 0.0);
        const glm::dvec3 eye = at + glm::dvec3(-std::tan(angle), 0, 1) * height;
        return scene.radiance(eye, at, kBackground);
    }
};

// A ray between mirrors at z = 0 and z = 1 that starts at x = 0, z = 0.5 and leaves the last one behind at
// x = 6 has met one each time that it has gone up or down by 1.
TEST_F(Glass, MirrorsThatFaceEachOtherWeakenLightByAPowerOfTheirReflectance) {
    constexpr double kReflected = 0.8;
    const auto sheet = [](float z) { return makeFloor({0, -1}, {6, 1}, z); };
    test::SceneSettings settings;
    settings.maxDepth = 16;
    const SceneOnGpu scene(*context,
                           test::joinedParts({{sheet(0), test::mirror(float(kReflected))},
                                              {sheet(1), test::mirror(float(kReflected))}}),
                           settings);
    for (int bounces = 0; bounces <= 12; ++bounces) {
        const double slope = bounces / 6.0; // the ray leaves half way between two bounces
        const glm::dvec3 eye(0.0, 0.1, 0.5);
        EXPECT_TRUE(isNear(scene.radiance(eye, eye + glm::dvec3(1, 0, slope), kBackground),
                           glm::dvec3(kBackground) * std::pow(kReflected, bounces), 2e-5))
            << bounces << " bounces";
    }
}

// Intensities behind borders that light passes back and forth between: part reflected, part let through.
struct Layer {
    double reflected, passed;
};
Layer behind(const Layer& first, const Layer& second) {
    const double between = 1.0 / (1.0 - first.reflected * second.reflected);
    return {first.reflected + first.passed * first.passed * second.reflected * between,
            first.passed * second.passed * between};
}

double inside(double angle, double index) {
    return std::asin(std::sin(angle) / index);
}

TEST_F(Glass, ASlabReflectsAndLetsThroughWhatFresnelsEquationsSay) {
    const SceneOnGpu scene(*context,
                           test::joinedParts({{makeBox({-60, -2, -1}, {60, 2, 0}), glass(kIndex)},
                                              {makeFloor({-60, -2}, {60, 2}, -2), glowing(kGlow)}}));
    for (const double degrees : {0.0, 20.0, 40.0, 56.31, 65.0, 75.0}) {
        const double angle = glm::radians(degrees), once = fresnel(angle, 1.0, kIndex);
        const Layer slab = behind({once, 1.0 - once}, {once, 1.0 - once});
        const glm::dvec3 expected =
            glm::dvec3(kGlow) * slab.passed + glm::dvec3(kBackground) * slab.reflected;
        EXPECT_TRUE(isNear(down(scene, angle, 0.5), expected, kUntraced)) << degrees << " degrees";
    }
}

TEST_F(Glass, AThickColouredSlabTakesColourOutOfLightAsBeersLawSays) {
    constexpr double kThickness = 1.7, kDistance = 0.6;
    const glm::dvec3 left(0.8, 0.5, 0.3);
    Material material = glass(kIndex);
    material.transmission.z = float(kDistance);
    material.attenuation = glm::vec4(left, 1.0f);
    const SceneOnGpu scene(*context,
                           test::joinedParts({{makeBox({-60, -2, float(-kThickness)}, {60, 2, 0}), material},
                                              {makeFloor({-60, -2}, {60, 2}, -2), glowing(kGlow)}}));
    for (const double degrees : {0.0, 30.0, 60.0}) {
        const double angle = glm::radians(degrees), once = fresnel(angle, 1.0, kIndex);
        const double way = kThickness / std::cos(inside(angle, kIndex));
        glm::dvec3 expected;
        for (int c = 0; c < 3; ++c) {
            const double kept = std::pow(left[c], way / kDistance);
            const double again = 1.0 / (1.0 - once * once * kept * kept);
            const double passed = (1.0 - once) * (1.0 - once) * kept * again;
            const double reflected = once + (1.0 - once) * (1.0 - once) * once * kept * kept * again;
            expected[c] = kGlow[c] * passed + kBackground[c] * reflected;
        }
        EXPECT_TRUE(isNear(down(scene, angle, 0.5), expected, kUntraced)) << degrees << " degrees";
    }
}

// A pane whose two faces are one: light between them goes back and forth, R = 2 F / (1 + F).
TEST_F(Glass, AThinPaneReflectsFromBothItsFacesAndDoesNotBend) {
    const glm::dvec3 tint(0.9, 0.6, 0.3);
    Material material = glass(kIndex, tint);
    material.more.y = kMaterialThin;
    const SceneOnGpu scene(*context, test::joinedParts({{makeFloor({-60, -2}, {60, 2}, 0), material},
                                                        {makeFloor({0, -2}, {60, 2}, -2), glowing(kGlow)}}));
    for (const double degrees : {0.0, 40.0, 60.0, 80.0}) {
        const double angle = glm::radians(degrees), once = fresnel(angle, 1.0, kIndex);
        const double reflected = 2.0 * once / (1.0 + once);
        const auto expected = [&](const glm::dvec3& beyond) {
            return beyond * tint * (1.0 - reflected) + glm::dvec3(kBackground) * reflected;
        };
        const double edge = -2.0 * std::tan(angle); // where the ray to the glowing floor's edge passes
        EXPECT_TRUE(isNear(down(scene, angle, 0.5, edge + 1e-3), expected(kGlow), 2e-5)) << degrees;
        EXPECT_TRUE(isNear(down(scene, angle, 0.5, edge - 1e-3), expected(kBackground), 2e-5)) << degrees;
    }
}

TEST_F(Glass, MetalReflectsItsColourAndWhiteAtGrazingAngles) { // Schlick 1994
    const glm::dvec3 color(0.95, 0.6, 0.2);
    const SceneOnGpu scene(*context, [&] {
        Mesh mesh = makeFloor({-60, -2}, {60, 2}, 0);
        mesh.materials = std::vector<Material>{test::metal(color, 0.0f)};
        return mesh;
    }());
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 88.0}) {
        const double angle = glm::radians(degrees);
        const glm::dvec3 part = color + (1.0 - color) * std::pow(1.0 - std::cos(angle), 5.0);
        EXPECT_TRUE(isNear(down(scene, angle, 0.5), part * glm::dvec3(kBackground), 5e-5)) << degrees;
    }
}

// From inside a slab: all is reflected beyond asin(1 / n), and what Fresnel says before.
TEST_F(Glass, TotalReflectionBeginsAtTheCriticalAngleAndIsApproachedAsFresnelSays) {
    const SceneOnGpu scene(*context,
                           test::joinedParts({{makeBox({-60, -60, 0}, {60, 60, 2}), glass(kIndex)},
                                              {makeFloor({-59, -59}, {59, 59}, 0.5f), glowing(kGlow)}}));
    const double critical = std::asin(1.0 / kIndex);
    for (const double angle : {0.0, 0.5 * critical, 0.9 * critical, critical - 1e-3, critical + 1e-4, 1.0}) {
        const double reflected = fresnel(angle, kIndex, 1.0);
        const glm::dvec3 eye(0.1, 0.2, 1);
        EXPECT_TRUE(
            isNear(scene.radiance(eye, eye + glm::dvec3(std::sin(angle), 0, std::cos(angle)), kBackground),
                   glm::dvec3(kGlow) * reflected + glm::dvec3(kBackground) * (1.0 - reflected), 1e-3))
            << angle << " rad";
    }
}

/// Layers of media one on the other, from the top (z = 0) downwards, in air.
struct Stack {
    std::vector<double> index, thickness;

    Layer optics(double angle) const {
        Layer sum{0.0, 1.0};
        double above = 1.0;
        for (std::size_t i = 0; i <= index.size(); ++i) {
            const double below = i < index.size() ? index[i] : 1.0;
            const double reflected = fresnel(inside(angle, above), above, below);
            sum = behind(sum, {reflected, 1.0 - reflected});
            above = below;
        }
        return sum;
    }
    /// How far the ray gets sideways within the stack.
    double sideways(double angle) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < index.size(); ++i)
            sum += thickness[i] * std::tan(inside(angle, index[i]));
        return sum;
    }
    double depth() const {
        double sum = 0.0;
        for (const double t : thickness) sum += t;
        return sum;
    }
};

class Layers : public Glass {
protected:
    // `solids` fill the space from z = 0 down to -depth; a glowing floor from x = 0 on lies 0.5 below.
    static void expectStack(std::vector<test::Part> solids, const Stack& stack) {
        const double ground = -stack.depth() - 0.5;
        solids.push_back({makeFloor({0, -50}, {60, 50}, float(ground)), glowing(kGlow)});
        test::SceneSettings settings;
        settings.maxDepth = 16;
        const SceneOnGpu scene(*context, test::joinedParts(solids), settings);
        for (const double degrees : {0.0, 25.0, 50.0, 65.0}) {
            const double angle = glm::radians(degrees);
            const Layer all = stack.optics(angle);
            const double edge = -(stack.sideways(angle) + 0.5 * std::tan(angle));
            for (const double beside : {-2e-3, 2e-3}) {
                const glm::dvec3 color = down(scene, angle, 0.5, edge + beside);
                // What comes after two more reflections, from elsewhere, is little.
                EXPECT_TRUE(isNear(color, lit(all, beside > 0.0 ? kGlow : kBackground), 0.2))
                    << degrees << " degrees, beside by " << beside;
            }
            EXPECT_TRUE(isNear(down(scene, angle, 0.5, 20.0), lit(all, kGlow), 5e-3))
                << degrees << " degrees, far from the edge";
        }
    }
    static glm::dvec3 lit(const Layer& all, const glm::vec3& beyond) {
        return glm::dvec3(beyond) * all.passed + glm::dvec3(kBackground) * all.reflected;
    }
};

TEST_F(Layers, WaterInsideGlassHasThreeIndices) {
    expectStack({{makeBox({-50, -50, -3}, {50, 50, 0}), glass(1.5f)},
                 {makeBox({-49, -49, -2}, {49, 49, -1}), glass(1.33f)}},
                {{1.5, 1.33, 1.5}, {1, 1, 1}});
}

TEST_F(Layers, BoxesOfOneIndexThatOverlapAreOne) {
    expectStack({{makeBox({-50, -50, -1.1f}, {50, 50, 0}), glass(1.5f)},
                 {makeBox({-49, -49, -2}, {49, 49, -0.9f}), glass(1.5f)}},
                {{1.5}, {2}});
}

// The one that was entered last counts where both are.
TEST_F(Layers, WhereSolidsOverlapTheLastOneEnteredCounts) {
    expectStack({{makeBox({-50, -50, -1.2f}, {50, 50, 0}), glass(1.5f)},
                 {makeBox({-49, -49, -2}, {49, 49, -0.8f}), glass(1.33f)}},
                {{1.5, 1.33}, {0.8, 1.2}});
}

// A ray at height h beside the axis of a ball of radius 1 turns twice by asin(h) - asin(h / n), and keeps its
// distance from the centre.
double lensOffset(double h, double below) {
    const double turn = 2.0 * (std::asin(h) - std::asin(h / kIndex));
    return (h / std::sin(turn) - below) * std::tan(turn);
}

TEST_F(Glass, ABallFocusesParallelRays) {
    constexpr double kHalfSide = 0.05;
    constexpr unsigned kSize = 48;
    const double focus = kIndex / (2.0 * (kIndex - 1.0));
    EXPECT_NEAR(lensOffset(1e-3, focus), 0.0, 1e-8); // paraxial
    for (const double below : {focus, 0.85 * focus, 1.3 * focus}) {
        const float half = float(kHalfSide);
        test::SceneSettings settings;
        settings.view = kOrthographicView;
        const SceneOnGpu scene(
            *context,
            test::joinedParts({{test::makeSphere(6), glass(kIndex)},
                               {makeFloor({-half, -half}, {half, half}, float(-below)), glowing({1, 1, 1})}}),
            settings);
        test::Shot shot;
        shot.pose = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}};
        shot.pose.view = kOrthographicView;
        shot.pose.height = 1.4;
        shot.size = glm::uvec2(kSize);
        const FilmPixels pixels = scene.render(shot);
        int seen = 0;
        for (unsigned i = 0; i < kSize * kSize; ++i) {
            const glm::dvec2 place = (glm::dvec2(i % kSize, i / kSize) + 0.5) * (1.4 / kSize) - 0.7;
            const double h = glm::length(place);
            const glm::dvec2 at = place / h * lensOffset(h, below);
            const double reach = std::max(std::abs(at.x), std::abs(at.y));
            if (std::abs(reach - kHalfSide) < 2e-3) continue; // the ball is made of 81,920 triangles
            const bool glows = reach < kHalfSide;
            seen += glows;
            const double once = fresnel(std::asin(h), 1.0, kIndex);
            const double passed = (1.0 - once) * (1.0 - once);
            EXPECT_NEAR(pixels.colors[i].x, glows ? passed : 0.0, 5e-3) << place.x << " " << place.y;
        }
        EXPECT_GT(seen, 20);
    }
}

} // namespace
} // namespace rt
