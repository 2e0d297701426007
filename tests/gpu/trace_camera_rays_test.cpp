// Rays of all kinds of cameras, lenses, filters, and the samples that pixels are made of.
#include "tests/gpu/scene_fixture.h"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <cstring>
#include <functional>

namespace rt {
namespace {

using test::glowing;
using test::makeFloor;
using test::SceneOnGpu;
using test::SceneSettings;
using test::Shot;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTilt = 0.3;

class CameraRays : public test::OnGpu {
protected:
    static Mesh glowingFloor(glm::vec2 lo, glm::vec2 hi, float z) {
        Mesh mesh = makeFloor(lo, hi, z);
        mesh.materials = std::vector<Material>{glowing(glm::vec3(1.0f))};
        return mesh;
    }
    static SceneSettings viewOf(unsigned view) {
        SceneSettings settings;
        settings.view = view;
        settings.aovs = true;
        return settings;
    }
};

TEST_F(CameraRays, AnOrthographicViewShowsPlacesBesideEachOther) {
    const SceneOnGpu scene(*context, glowingFloor({-9, -9}, {9, 9}, 0), viewOf(kOrthographicView));
    Shot shot;
    shot.pose = {{0.5, -0.25, 3}, {0.5 + 3 * kTilt, -0.25, 0}, {0, 1, 0}};
    shot.pose.view = kOrthographicView;
    shot.pose.height = 2.0;
    shot.size = {12, 8};
    const FilmPixels pixels = scene.render(shot);
    const glm::dvec3 forward = glm::normalize(glm::dvec3(3 * kTilt, 0, -3));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    for (unsigned i = 0; i < 12 * 8; ++i) {
        const double x = 0.25 * (i % 12 + 0.5) - 1.5, y = 1.0 - 0.25 * (i / 12 + 0.5);
        const glm::dvec3 start = shot.pose.eye + right * x + glm::dvec3(0, y, 0);
        const double depth = start.z / -forward.z;
        EXPECT_LT(glm::distance(glm::dvec3(glm::vec3(pixels.positions[i])), start + forward * depth), 2e-6)
            << i;
        EXPECT_NEAR(pixels.surfaces[i].w, depth, 2e-6) << i;
    }
}

TEST_F(CameraRays, APanoramaShowsAllDirections) {
    const SceneOnGpu scene(*context, test::moved(test::makeCube(), 4.0f, {0.1f, 0.2f, 0.3f}),
                           viewOf(kPanoramaView));
    Shot shot;
    shot.pose = {{0.3, -0.2, 0.4}, {1.3, -0.2, 0.4}, {0, 0, 1}};
    shot.pose.view = kPanoramaView;
    shot.size = {24, 12};
    const FilmPixels pixels = scene.render(shot);
    for (unsigned i = 0; i < 24 * 12; ++i) {
        const double longitude = kPi * (2.0 * (i % 24 + 0.5) / 24 - 1.0),
                     latitude = kPi * (0.5 - (i / 24 + 0.5) / 12);
        // Forward is +x, up +z, so right is -y.
        const glm::dvec3 direction(std::cos(latitude) * std::cos(longitude),
                                   -std::cos(latitude) * std::sin(longitude), std::sin(latitude));
        const glm::dvec3 way = glm::dvec3(glm::vec3(pixels.positions[i])) - shot.pose.eye;
        EXPECT_LT(glm::distance(glm::normalize(way), direction), 3e-6) << i;
        EXPECT_NEAR(pixels.surfaces[i].w, glm::length(way), 3e-6) << i;
    }
}

// Brightness about its middle, in pixels.
struct Spot {
    double sum = 0.0;
    glm::dvec2 mean{0.0}, variance{0.0};
    double reach = 0.0;
};
Spot spotOf(const FilmPixels& pixels, unsigned side) {
    Spot spot;
    const auto place = [&](std::size_t i) {
        return glm::dvec2(double(i % side), double(i / side)) + 0.5 - 0.5 * side;
    };
    for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
        spot.sum += pixels.colors[i].x;
        spot.mean += double(pixels.colors[i].x) * place(i);
    }
    spot.mean /= spot.sum;
    for (std::size_t i = 0; i < pixels.colors.size(); ++i) {
        const glm::dvec2 off = place(i) - spot.mean;
        spot.variance += double(pixels.colors[i].x) * off * off / spot.sum;
        if (pixels.colors[i].x > 0.0f) spot.reach = std::max(spot.reach, glm::length(off));
    }
    return spot;
}

// A patch whose image is half a pixel wide, at the distance in focus and at twice that: there the lens is
// seen as a disc of half its radius on the plane in focus, of variance radius^2 / 4 along each axis.
TEST_F(CameraRays, ALensIsSharpAtItsDistanceAndBlursBeyondByItsCircleOfConfusion) {
    constexpr double kFocus = 2.0, kLens = 0.2, kFov = 14.0;
    constexpr unsigned kSide = 15; // the patch is in the middle of a pixel
    const double pixel = 2.0 * std::tan(glm::radians(kFov / 2)) / kSide; // at distance 1
    for (const double distance : {kFocus, 2.0 * kFocus}) {
        const float half = float(0.25 * pixel * distance);
        SceneSettings settings;
        settings.lens = true;
        settings.multisample = true;
        const SceneOnGpu scene(*context, glowingFloor({-half, -half}, {half, half}, float(-distance)),
                               settings);
        Shot shot;
        shot.pose = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}};
        shot.pose.fovDegrees = kFov;
        shot.pose.lensRadius = kLens;
        shot.pose.focusDistance = kFocus;
        shot.size = glm::uvec2(kSide);
        shot.samples = 1u << 14;
        shot.samplesPerDispatch = 64;
        shot.filterRadius = 0.5f;
        const Spot spot = spotOf(scene.render(shot), kSide);
        const double circle =
            kLens * std::abs(distance - kFocus) / distance / kFocus / pixel; // radius, pixels
        EXPECT_NEAR(spot.sum, 0.25, 0.012);                                  // the patch's area in pixels
        EXPECT_NEAR(spot.mean.x, 0.0, 0.1);
        EXPECT_NEAR(spot.mean.y, 0.0, 0.1);
        if (circle == 0.0) {
            EXPECT_EQ(spot.reach, 0.0);
            continue;
        }
        // What falls on a pixel counts as in its middle: the patch's and the pixel's own width add up.
        const double variance = 0.25 * circle * circle + 0.25 / 12.0 + 1.0 / 12.0;
        EXPECT_NEAR(spot.variance.x, variance, 0.04 * variance);
        EXPECT_NEAR(spot.variance.y, variance, 0.04 * variance);
        EXPECT_GT(spot.reach, circle - 1.0);
        EXPECT_LT(spot.reach, circle + 1.5);
    }
}

/// Part of a filter's weight left of x, for a filter of radius 1 in x with y summed up.
double weightLeftOf(double x, const std::function<double(double)>& weight) {
    constexpr int kSteps = 4000;
    double left = 0.0, all = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double at = 2.0 * (i + 0.5) / kSteps - 1.0;
        all += weight(at);
        if (at < x) left += weight(at);
    }
    return left / all;
}

double blackmanHarris(double x) { // Harris 1978
    const double t = kPi * (x + 1.0);
    return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
}
// exp(-r^2 / (2 / 9)) within the unit disc.
double gaussian(double x) {
    constexpr int kSteps = 400;
    const double reach = std::sqrt(std::max(1.0 - x * x, 0.0));
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double y = reach * (2.0 * (i + 0.5) / kSteps - 1.0);
        sum += std::exp(-4.5 * (x * x + y * y)) * 2.0 * reach / kSteps;
    }
    return sum;
}

// About 0, for radius 1: 1/9 (1 - a / (e^a - 1)), a = 9/2; and 1/3 + 2 sum of a_k / (k pi)^2 / a_0.
constexpr double kGaussianVariance = 0.105494, kBlackmanHarrisVariance = 0.076737;

struct FilterCase {
    unsigned kind;
    double radius; // pixels
    std::function<double(double)> weight;
    double variance; // radius 1
};

// Of a pixel of width 1 whose left part, up to `edge` radii from its middle, is light; turned round, its
// upper part.
double seenBy(const SceneOnGpu& scene, const FilterCase& filter, double edge, bool upright) {
    Shot shot;
    shot.pose = {{-edge * filter.radius, 0, 1}, {-edge * filter.radius, 0, 0}, {0, 1, 0}};
    if (upright) shot.pose.up = {-1, 0, 0};
    shot.pose.view = kOrthographicView;
    shot.pose.height = 1.0;
    shot.samples = 1024;
    shot.samplesPerDispatch = 64;
    shot.filter = filter.kind;
    shot.filterRadius = float(filter.radius);
    return scene.render(shot).colors[0].x;
}

// A pixel on an edge between dark and light shows the part of the filter that is on the light side.
TEST_F(CameraRays, FiltersWeighWhatIsBesideThePixelAsTheirFormulaSays) {
    const FilterCase cases[] = {{kFilterBox, 0.5, [](double) { return 1.0; }, 1.0 / 3.0},
                                {kFilterTent, 1.0, [](double x) { return 1.0 - std::abs(x); }, 1.0 / 6.0},
                                {kFilterGaussian, 1.5, gaussian, kGaussianVariance},
                                {kFilterBlackmanHarris, 2.0, blackmanHarris, kBlackmanHarrisVariance}};
    SceneSettings settings;
    settings.view = kOrthographicView;
    settings.multisample = true;
    const SceneOnGpu scene(*context, glowingFloor({-9, -9}, {0, 9}, 0), settings);
    for (const FilterCase& filter : cases)
        for (const bool upright : {false, true}) {
            constexpr int kSteps = 16;
            double mean = 0.0, variance = 0.0; // by parts, from the distribution
            for (int i = -kSteps; i <= kSteps; ++i) {
                const double edge = double(i) / kSteps;
                const double found = seenBy(scene, filter, edge, upright);
                EXPECT_NEAR(found, weightLeftOf(edge, filter.weight), 8e-3) << filter.kind << " at " << edge;
                const double beyond = found - (edge > 0.0 ? 1.0 : edge < 0.0 ? 0.0 : 0.5);
                mean -= beyond / kSteps;
                variance -= 2.0 * edge * beyond / kSteps;
            }
            EXPECT_NEAR(mean, 0.0, 2e-3) << filter.kind;
            EXPECT_NEAR(variance, filter.variance, 3e-3) << filter.kind;
        }
}

// Everything that is random, in one scene.
Mesh makeMotley() {
    return test::joinedParts({{makeFloor({-4, -4}, {4, 4}, -1), test::matt(0.7f)},
                              {test::makeSphere(2, 0.7f), test::metal({0.9f, 0.7f, 0.3f}, 0.4f)},
                              {test::moved(test::makeSphere(2), 0.4f, {1.1f, 0.2f, 0}), test::glass(1.5f)}});
}

SceneSettings motleySettings() {
    Light light = pointLight({0, 0, 3}, glm::vec3(2.0f));
    light.kind.x = kLightSphere;
    light.position.w = 0.5f;
    SceneSettings settings;
    settings.lights = {light};
    settings.environment = test::evenEnvironment({0.2f, 0.3f, 0.5f});
    settings.lens = true;
    settings.multisample = true;
    return settings;
}

Shot motleyShot() {
    Shot shot;
    shot.pose = {{0.5, -3, 2.5}, {0.3, 0, 0}, {0, 0, 1}};
    shot.pose.lensRadius = 0.05;
    shot.pose.focusDistance = 3.0;
    shot.size = {37, 29};
    shot.samples = 12;
    shot.filterRadius = 1.0f;
    shot.filter = kFilterTent;
    return shot;
}

bool sameBits(const FilmPixels& a, const FilmPixels& b) {
    return std::memcmp(a.colors.data(), b.colors.data(), a.colors.size() * sizeof(glm::vec4)) == 0 &&
           std::memcmp(a.surfaces.data(), b.surfaces.data(), a.surfaces.size() * sizeof(glm::vec4)) == 0 &&
           a.ids == b.ids && a.variances == b.variances;
}

TEST_F(CameraRays, OneSeedGivesOnePictureHoweverItsSamplesAreCut) {
    const SceneOnGpu scene(*context, makeMotley(), motleySettings());
    Shot shot = motleyShot();
    const FilmPixels first = scene.render(shot);
    EXPECT_TRUE(sameBits(first, scene.render(shot)));
    for (const unsigned count : {1u, 5u, 12u}) {
        shot.samplesPerDispatch = count;
        EXPECT_TRUE(sameBits(first, scene.render(shot))) << count << " samples a dispatch";
    }
    shot.seed = 1;
    const FilmPixels other = scene.render(shot);
    EXPECT_FALSE(sameBits(first, other));
    std::size_t same = 0;
    double difference = 0.0;
    for (std::size_t i = 0; i < first.colors.size(); ++i) {
        same += first.colors[i] == other.colors[i];
        difference += double(first.colors[i].y) - double(other.colors[i].y);
    }
    EXPECT_LT(same, first.colors.size() / 4); // the sky has no noise
    EXPECT_LT(std::abs(difference) / double(first.colors.size()), 0.01);
}

// The pairs of numbers by themselves.
constexpr unsigned kMostSamples = 1024;

std::vector<glm::vec2> pairsOf(unsigned pixelX, unsigned seed, unsigned purpose, unsigned depth) {
    const std::string entry =
        fmt::format("#include \"formats/shared_types.shared.h\"\n"
                    "const float kPi = 3.14159265f;\n"
                    "struct P {{ uvec4 samples; }};\nconst P picture = P(uvec4(0u, 0u, {}u, 0u));\n"
                    "#include \"shaders/random.glsl\"\n"
                    "layout(local_size_x = 64) in;\n"
                    "layout(std430, binding = 0) writeonly buffer Out {{ vec2 pairs[]; }};\n"
                    "void main() {{\n    uint i = gl_GlobalInvocationID.x;\n"
                    "    pairs[i] = pairOf(samplerOf(uvec2({}u, 7u), i), {}u, {}u);\n}}\n",
                    seed, pixelX, purpose, depth);
    const GlProgram program = compileComputeProgram(composeShader(
        "#version 450 core\n", "entry", [&](std::string_view path) -> std::optional<std::string> {
            return path == "entry" ? entry : embeddedShader(path);
        }));
    const GlBuffer out = createOutputBuffer(kMostSamples * sizeof(glm::vec2));
    glUseProgram(program.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, out.name());
    glDispatchCompute(kMostSamples / 64, 1, 1);
    std::vector<glm::vec2> pairs(kMostSamples);
    readBuffer(out, std::as_writable_bytes(std::span(pairs)));
    return pairs;
}

// A (0, 2)-sequence in base 2 (Sobol 1967): of 2^k samples one falls into each box of width 2^-a and height
// 2^-(k - a), and that for every run of them that begins at a multiple.
void expectElementary(const std::vector<glm::vec2>& pairs) {
    for (unsigned k = 0; k <= 10; ++k)
        for (unsigned first = 0; first + (1u << k) <= kMostSamples; first += 1u << k)
            for (unsigned a = 0; a <= k; ++a) {
                std::vector<bool> taken(1u << k);
                for (unsigned i = first; i < first + (1u << k); ++i) {
                    const auto x = static_cast<unsigned>(pairs[i].x * float(1u << a));
                    const auto y = static_cast<unsigned>(pairs[i].y * float(1u << (k - a)));
                    ASSERT_LT(x, 1u << a);
                    ASSERT_LT(y, 1u << (k - a));
                    const unsigned box = (x << (k - a)) | y;
                    ASSERT_FALSE(taken[box]) << "2^" << k << " samples from " << first << ", sample " << i;
                    taken[box] = true;
                }
            }
}

TEST_F(CameraRays, PairsFallOneIntoEachElementaryBox) {
    for (const unsigned pixel : {0u, 1u, 500u})
        for (const unsigned purpose : {0u, 3u})
            for (const unsigned depth : {0u, 2u}) {
                SCOPED_TRACE(fmt::format("pixel {}, purpose {}, depth {}", pixel, purpose, depth));
                expectElementary(pairsOf(pixel, 5, purpose, depth));
            }
}

// Of pairs for different ends, pixels and seeds, the first numbers know nothing of each other.
TEST_F(CameraRays, PairsForDifferentEndsAreNotCorrelated) {
    const std::vector<std::vector<glm::vec2>> all = {pairsOf(0, 5, 0, 0), pairsOf(0, 5, 1, 0),
                                                     pairsOf(0, 5, 0, 1), pairsOf(1, 5, 0, 0),
                                                     pairsOf(0, 6, 0, 0)};
    for (std::size_t a = 0; a < all.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            for (int c = 0; c < 2; ++c) {
                double sum = 0.0;
                for (unsigned i = 0; i < kMostSamples; ++i)
                    sum += (double(all[a][i].x) - 0.5) * (double(all[b][i][c]) - 0.5);
                EXPECT_LT(std::abs(12.0 * sum / kMostSamples), 4.0 / std::sqrt(kMostSamples))
                    << a << " " << b;
            }
}

} // namespace
} // namespace rt
