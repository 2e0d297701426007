// Shadows, mirrors, glass and textures against what geometrical optics says, one ray at a time.
#include "common/error.h"
#include "tests/gpu/scene_fixture.h"

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>
#include <random>

namespace rt {
namespace {

constexpr glm::vec3 kBackground(0.25f, 0.5f, 0.75f);
constexpr glm::vec3 kGlow(0.9f, 0.2f, 0.4f);

Material glowing() {
    return test::glowing(kGlow);
}
// Nothing is reflected but what cannot get through.
Material glass(double index) {
    Material material = test::glass(static_cast<float>(index));
    material.reflection.z = 0.0f;
    return material;
}

glm::vec3 colorTowards(const test::SceneOnGpu& scene, const glm::dvec3& eye, const glm::dvec3& lookAt) {
    return glm::vec3(scene.radiance(eye, lookAt, kBackground));
}

testing::AssertionResult isColor(const glm::vec3& color, const glm::vec3& expected) {
    if (glm::distance(color, expected) < 2e-4f) return testing::AssertionSuccess();
    return testing::AssertionFailure() << color.r << " " << color.g << " " << color.b << ", not "
                                       << expected.r << " " << expected.g << " " << expected.b;
}

class Optics : public test::OnGpu {};

// A box of half width 0.5 from z = 1 to 1.5 between a floor at 0 and a light at 4: its upper edge casts the
// shadow's, at 0.5 * 4 / 2.5 = 0.8.
TEST_F(Optics, ABoxCastsAShadowWithItsEdgeWhereTheLightsRaysGrazeIt) {
    constexpr float kAmbient = 0.25f;
    constexpr float kIntensity = 30.0f;
    const test::SceneOnGpu scene(
        *context,
        test::joinedParts({{test::makeFloor({-4, -4}, {4, 4}, 0.0f), test::matt(0.8f)},
                           {test::makeBox({-0.5f, -0.5f, 1.0f}, {0.5f, 0.5f, 1.5f}), test::matt(0.8f)},
                           // Beyond the light, and so in nobody's way.
                           {test::makeBox({-1.0f, -1.0f, 5.0f}, {1.0f, 1.0f, 5.5f}), test::matt(0.8f)}}),
        {.lights = {pointLight({0, 0, 4}, glm::vec3(kIntensity))}, .ambient = kAmbient});
    for (const glm::dvec2 towards : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        for (const double distance : {0.1, 0.7, 0.799, 0.801, 0.9, 3.0}) {
            const glm::dvec3 point(towards * distance, 0.0);
            const double squared = distance * distance + 16.0;
            const double direct = kIntensity * (4.0 / std::sqrt(squared)) / (M_PI * squared);
            const double received = kAmbient + (distance > 0.8 ? direct : 0.0);
            EXPECT_TRUE(isColor(colorTowards(scene, glm::dvec3(towards * 3.9, 0.5), point),
                                glm::vec3(float(0.8 * received))))
                << towards.x << " " << towards.y << " at " << distance;
        }
    }
}

// The mirror image of the box [1, 2] x [-0.2, 0.2] x [2, 2.4] in the plane z = 0.
TEST_F(Optics, AMirrorShowsAnObjectAtItsMirroredPlace) {
    const test::SceneOnGpu scene(
        *context, test::joinedParts({{test::makeFloor({-5, -5}, {5, 5}, 0.0f), test::mirror(1.0f)},
                                     {test::makeBox({1.0f, -0.2f, 2.0f}, {2.0f, 0.2f, 2.4f}), glowing()}}));
    const glm::dvec3 eye(-2.5, 0, 3);
    const auto expectEdge = [&](const glm::dvec3& inside, const glm::dvec3& outside) {
        EXPECT_TRUE(isColor(colorTowards(scene, eye, inside), kGlow))
            << inside.x << " " << inside.y << " " << inside.z;
        EXPECT_TRUE(isColor(colorTowards(scene, eye, outside), kBackground))
            << outside.x << " " << outside.y << " " << outside.z;
    };
    expectEdge({1.998, 0, -2}, {2.002, 0, -2});     // the far lower edge
    expectEdge({1, 0, -2.398}, {1, 0, -2.402});     // the near upper edge
    expectEdge({1.5, 0.199, -2}, {1.5, 0.201, -2}); // the sides
    expectEdge({1.5, -0.199, -2}, {1.5, -0.201, -2});
}

// A slab of thickness d and index n moves a ray that meets it at angle i sideways by
// d sin(i) (1 - cos(i) / sqrt(n^2 - sin^2(i))) and leaves its direction as it is (Snell's law, twice).
TEST_F(Optics, AGlassSlabDisplacesWhatIsBehindIt) {
    constexpr double kIor = 1.5;
    const test::SceneOnGpu scene(*context,
                                 test::joinedParts({{test::makeBox({-45, -2, 0}, {10, 2, 1}), glass(kIor)},
                                                    {test::makeFloor({0, -1}, {8, 1}, -2.0f), glowing()}}));
    for (const double degrees : {0.0, 10.0, 30.0, 50.0, 70.0, 80.0}) {
        const double i = glm::radians(degrees);
        const double sine = std::sin(i), cosine = std::cos(i);
        const double sideways = sine * (1.0 - cosine / std::sqrt(kIor * kIor - sine * sine));
        // From z = 5 to z = -2, on to the edge of the glowing floor at x = 0.
        const double edge = -7.0 * std::tan(i) + sideways / cosine;
        for (const double beside : {-0.003, 0.003}) {
            const glm::dvec3 eye(edge + beside, 0.1, 5);
            EXPECT_TRUE(isColor(colorTowards(scene, eye, eye + glm::dvec3(sine, 0, -cosine)),
                                beside > 0.0 ? kGlow : kBackground))
                << degrees << " degrees";
        }
    }
}

// From inside, glass of index n reflects everything beyond asin(1 / n), and lets all else out.
TEST_F(Optics, GlassReflectsTotallyBeyondTheCriticalAngle) {
    constexpr double kIor = 1.5;
    const test::SceneOnGpu scene(
        *context, test::joinedParts({{test::makeBox({-20, -20, 0}, {20, 20, 2}), glass(kIor)},
                                     {test::makeFloor({-19, -19}, {19, 19}, 0.5f), glowing()}}));
    const double critical = std::asin(1.0 / kIor);
    for (const double i : {0.0, 0.5 * critical, critical - 1e-3, critical + 1e-3, 1.0, 1.4}) {
        const glm::dvec3 eye(0.1, 0.2, 1);
        EXPECT_TRUE(isColor(colorTowards(scene, eye, eye + glm::dvec3(std::sin(i), 0, std::cos(i))),
                            i > critical ? kGlow : kBackground))
            << i << " rad";
    }
}

// Source: IEC 61966-2-1 (sRGB).
double linearOf(std::uint32_t byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// Step by step, not by division as in the shader.
int wrapped(int texel, int size, std::uint32_t wrap) {
    if (wrap == kWrapClamp) return std::min(std::max(texel, 0), size - 1);
    while (texel < 0 || texel >= size) {
        if (wrap == kWrapRepeat)
            texel += texel < 0 ? size : -size;
        else
            texel = texel < 0 ? -1 - texel : 2 * size - 1 - texel;
    }
    return texel;
}

// Mean of the four texels whose centres are nearest, weighted by area.
glm::dvec3 bilinear(const Mesh& mesh, glm::dvec2 texcoord) {
    const MeshImage& image = mesh.images[0];
    const double x = texcoord.x * image.width - 0.5;
    const double y = (1.0 - texcoord.y) * image.height - 0.5;
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    glm::dvec3 sum(0.0);
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const auto column =
                static_cast<std::size_t>(wrapped(left + dx, static_cast<int>(image.width), image.wrapU));
            const auto row =
                static_cast<std::size_t>(wrapped(top + dy, static_cast<int>(image.height), image.wrapV));
            const std::uint32_t texel = mesh.pixels[row * image.width + column];
            const double weight = (1.0 - std::abs(x - left - dx)) * (1.0 - std::abs(y - top - dy));
            for (int c = 0; c < 3; ++c) sum[c] += weight * linearOf((texel >> (8 * c)) & 0xFF);
        }
    return sum;
}

// A 4x3 image of noise, of which the unit square shows 4 x 4.5 periods.
Mesh makeNoiseSquare(std::uint32_t wrapU, std::uint32_t wrapV) {
    Mesh mesh = test::makeTexturedSquare({{4, 3}});
    mesh.texcoords = std::vector<glm::vec2>{{-1.5f, -2.0f}, {2.5f, -2.0f}, {2.5f, 2.5f}, {-1.5f, 2.5f}};
    mesh.images = std::vector<MeshImage>{{4, 3, wrapU, wrapV, 0}};
    std::mt19937 random(21);
    std::vector<std::uint32_t> pixels(12);
    for (std::uint32_t& pixel : pixels)
        pixel = 0xFF000000u | static_cast<std::uint32_t>(random() & 0xFFFFFFu);
    mesh.pixels = std::move(pixels);
    return mesh;
}

TEST_F(Optics, TexturesAreFilteredInLinearLightAndWrappedAsTheImageSays) {
    constexpr unsigned kSize = 96;
    constexpr float kSrgbError = 3e-3f; // software renderers decode sRGB by approximation
    for (const auto& [wrapU, wrapV] :
         {std::pair(kWrapRepeat, kWrapClamp), {kWrapClamp, kWrapMirror}, {kWrapMirror, kWrapRepeat}}) {
        const Mesh mesh = makeNoiseSquare(wrapU, wrapV);
        const test::SceneOnGpu scene(*context, mesh, {.ambient = 1.0f});
        // At distance 0.5 a field of view of 90 degrees is the square.
        const FilmPixels pixels =
            scene.render({{{0.5, 0.5, 0.5}, {0.5, 0.5, 0.0}, {0, 1, 0}, 90.0}, {kSize, kSize}});
        for (unsigned y = 0; y < kSize; ++y)
            for (unsigned x = 0; x < kSize; ++x) {
                if (x + y == kSize - 1)
                    continue; // where the two triangles meet, either may be missed by rounding
                const glm::dvec2 place((x + 0.5) / kSize, 1.0 - (y + 0.5) / kSize);
                const glm::dvec2 texcoord(-1.5 + 4.0 * place.x, -2.0 + 4.5 * place.y);
                const glm::vec3 expected(0.8 * bilinear(mesh, texcoord));
                ASSERT_LT(glm::distance(glm::vec3(pixels.colors[y * kSize + x]), expected), kSrgbError)
                    << "wrap " << wrapU << " " << wrapV << ", texture coordinates " << texcoord.x << " "
                    << texcoord.y;
            }
    }
}

TEST_F(Optics, TexturePagesLargerThanTheDeviceAllowsAreALimit) {
    const Atlas atlas = test::makeAtlas(test::makeTexturedSquare({{16, 16}}), kStructureCloud, {2, 2, 1});
    GlLimits tiny = limits();
    const ResourcePlan plan = planResources(atlas, renderFeatures(atlas, {.maxDepth = 0}), ShaderKind::Render,
                                            tiny.resources, "atlas");
    tiny.resources.textureBytes = atlas.pages.size_bytes();
    EXPECT_NO_THROW(uploadAtlas(atlas, plan, tiny, 0, "atlas"));
    tiny.resources.textureBytes -= 1;
    try {
        uploadAtlas(atlas, plan, tiny, 0, "atlas");
        FAIL() << "uploaded";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        EXPECT_NE(std::string(error.what()).find("bytes a texture"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace rt
