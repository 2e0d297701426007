// Pictures: shader variants, and what a picture holds.
#include "formats/image.h"
#include "tests/gpu/render_fixture.h"
#include "tools/rt-trace/render_image.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <cmath>
#include <cstring>

namespace rt {
namespace {

constexpr glm::uvec2 kSize(70, 133); // no multiples of the tile size, and several bands of rows

CameraPose defaultPose(const Atlas& atlas) {
    return placeCamera({}, test::boundsOfAtlas(atlas), double(kSize.x) / kSize.y);
}

class Rendering : public test::OnGpu {
protected:
    static test::Picture render(const Atlas& atlas, const SceneFeatures& features,
                                const std::optional<ResourceLimits>& resourceLimits = {}) {
        return test::renderPicture(*context, atlas, {features, defaultPose(atlas), kSize},
                                   resourceLimits ? *resourceLimits : limits().resources);
    }

    static SceneFeatures featuresOf(const Atlas& atlas) {
        return renderFeatures(atlas, {.maxDepth = 4, .lights = test::kTwoLights});
    }
};

Mesh withMaterial(Mesh mesh, const Material& material) {
    mesh.materials = std::vector<Material>{material};
    return mesh;
}

float largestDifference(const FilmPixels& a, const FilmPixels& b) {
    float largest = a.ids == b.ids ? 0.0f : 1e9f;
    for (std::size_t i = 0; i < a.colors.size(); ++i)
        for (int c = 0; c < 4; ++c)
            largest = std::max({largest, std::abs(a.colors[i][c] - b.colors[i][c]),
                                std::abs(a.surfaces[i][c] - b.surfaces[i][c])});
    return largest;
}

TEST_F(Rendering, EverySingleFeatureVariantCompiles) {
    const Atlas atlas = test::makeAtlas(test::makeCube(), kStructureUniform, {2, 2, 2});
    SceneFeatures all;
    const auto compilesAs = [&](ShaderKind kind, const SceneFeatures& features) {
        EXPECT_NO_THROW(compileVariant(planResources(atlas, features, kind, limits().resources, "atlas")))
            << featureDefines(features);
    };
    const auto compiles = [&](const SceneFeatures& features) {
        for (const ShaderKind kind : {ShaderKind::Render, ShaderKind::Query}) compilesAs(kind, features);
    };
    compiles(all);
    for (const FeatureRow& row : featureTable()) {
        if (row.field == &SceneFeatures::subgroups && !limits().subgroups) continue;
        if (row.field == &SceneFeatures::hasTime && !limits().shaderClock) continue;
        SceneFeatures one;
        if (row.field == &SceneFeatures::multipass) continue; // below
        one.*row.field = all.*row.field = row.field == &SceneFeatures::maxDepth ? 16 : 1;
        compiles(one);
    }
    compiles(all);
    SceneFeatures passes;
    passes.multipass = all.multipass = 1;
    compilesAs(ShaderKind::Render, passes);
    all.doublePrecision = all.hasTime = all.subgroups = 0;
    compilesAs(ShaderKind::Render, all);
}

TEST_F(Rendering, AFeatureThatTheSceneDoesNotUseDoesNotChangeThePicture) {
    const Atlas atlas = test::makeAtlas(test::makeSphere(2), kStructureCloud, {8, 8, 8});
    const FilmPixels plain = render(atlas, featuresOf(atlas)).pixels;
    for (const auto feature :
         {&SceneFeatures::hasSlivers, &SceneFeatures::hasTextures, &SceneFeatures::hasReflection,
          &SceneFeatures::hasTransmission, &SceneFeatures::hasEmission}) {
        SceneFeatures features = featuresOf(atlas);
        features.*feature = 1;
        features.maxDepth = 4;
        EXPECT_LE(largestDifference(plain, render(atlas, features).pixels), 1e-6f);
    }
}

TEST_F(Rendering, AFeatureThatTheSceneUsesDoesChangeThePicture) {
    Material material = test::greyMaterial();
    material.reflection.y = 0.0f;
    material.reflection.w = 0.3f;
    material.transmission.x = 0.4f / 0.7f;
    material.emission = glm::vec4(0.2f, 0.1f, 0.0f, 0.0f);
    const Atlas atlas =
        test::makeAtlas(withMaterial(test::makeSphere(2), material), kStructureCloud, {8, 8, 8});
    const SceneFeatures all = featuresOf(atlas);
    const FilmPixels full = render(atlas, all).pixels;
    EXPECT_EQ(countNonFinite(toImage(kSize, full, {defaultPose(atlas)})), 0u);
    for (const auto feature :
         {&SceneFeatures::hasReflection, &SceneFeatures::hasTransmission, &SceneFeatures::hasEmission,
          &SceneFeatures::lightCount, &SceneFeatures::maxDepth}) {
        SceneFeatures features = all;
        features.*feature = 0;
        EXPECT_GT(largestDifference(full, render(atlas, features).pixels), 0.01f);
    }
}

TEST_F(Rendering, PerfectMirrorsAndClearGlassShowTheBackground) {
    for (const glm::vec2 optics : {glm::vec2(1, 0), glm::vec2(0, 1), glm::vec2(0.25f, 0.75f)}) {
        Material material = test::greyMaterial();
        material.baseColor = glm::vec4(1.0f);
        material.reflection.y = 0.0f;
        material.reflection.w = optics.x;
        material.transmission.x = optics.y > 0.0f ? 1.0f : 0.0f;
        material.transmission.y = 1.0f;
        const Atlas atlas =
            test::makeAtlas(withMaterial(test::makeCube(), material), kStructureCloud, {4, 4, 4});
        SceneFeatures features = featuresOf(atlas);
        features.maxDepth = 8;
        const FilmPixels pixels = render(atlas, features).pixels;
        for (const glm::vec4& color : pixels.colors)
            ASSERT_LT(glm::distance(glm::vec3(color), glm::vec3(0.25f, 0.5f, 0.75f)), 2e-3f) << optics.x;
    }
}

// Sums of the colours of each quarter of the picture.
struct Quarters {
    glm::vec4 topLeft{0}, topRight{0}, bottomLeft{0}, bottomRight{0};
};

Quarters sumQuarters(const FilmPixels& pixels) {
    Quarters sums;
    for (std::size_t i = 0; i < pixels.ids.size(); ++i) {
        if (pixels.ids[i] == kNoTriangle) continue;
        const bool left = i % kSize.x < kSize.x / 2;
        const bool top = i / kSize.x < kSize.y / 2;
        (top    ? left ? sums.topLeft : sums.topRight
         : left ? sums.bottomLeft
                : sums.bottomRight) += pixels.colors[i];
    }
    return sums;
}

TEST_F(Rendering, ShowsTheTextureTheRightWayUp) {
    Mesh mesh = test::makeTexturedSquare({{2, 2}});
    // Red and blue in the top row, black and green below.
    mesh.pixels = std::vector<std::uint32_t>{0xFF0000FFu, 0xFFFF0000u, 0xFF000000u, 0xFF00FF00u};
    const Atlas atlas = test::makeAtlas(mesh, kStructureCloud, {4, 4, 1});
    const Quarters sums = sumQuarters(render(atlas, featuresOf(atlas)).pixels);
    EXPECT_GT(sums.topLeft.r, 2.0f * (sums.topLeft.g + sums.topLeft.b));
    EXPECT_GT(sums.topRight.b, 2.0f * (sums.topRight.r + sums.topRight.g));
    EXPECT_GT(sums.bottomRight.g, 2.0f * (sums.bottomRight.r + sums.bottomRight.b));
    EXPECT_LT(sums.bottomLeft.r + sums.bottomLeft.g + sums.bottomLeft.b, sums.topLeft.r);
}

TEST_F(Rendering, PagesAndSlabsDoNotChangeThePicture) {
    const Atlas atlas =
        test::makeAtlas(test::makeTexturedSquare({{16, 16}, {8, 8}}), kStructureCloud, {4, 4, 9});
    ResourceLimits tiny = limits().resources;
    tiny.storageBlockBytes = 48; // one triangle a page
    tiny.textureSize3D = 4;
    const FilmPixels whole = render(atlas, featuresOf(atlas)).pixels;
    EXPECT_EQ(largestDifference(whole, render(atlas, featuresOf(atlas), tiny).pixels), 0.0f);
}

TEST_F(Rendering, CountsWorkWithoutChangingThePicture) {
    const Atlas atlas = test::makeAtlas(test::makeSphere(2), kStructureCloud, {8, 8, 8});
    SceneFeatures features = featuresOf(atlas);
    const FilmPixels plain = render(atlas, features).pixels;
    features.countWork = 1;
    const test::Picture counted = render(atlas, features);
    EXPECT_LE(largestDifference(plain, counted.pixels), 1e-6f);
    for (std::size_t i = 0; i < counted.counters.size(); ++i) {
        const glm::uvec4& counter = counted.counters[i];
        const bool hit = plain.ids[i] != kNoTriangle;
        ASSERT_GE(counter.x, 1u);
        ASSERT_LE(counter.x, hit ? 3u : 1u); // the primary ray, and one to each light
        ASSERT_GE(counter.z, hit ? 1u : 0u);
    }
    const WorkTotals totals = sumWork(counted.counters);
    EXPECT_GT(totals.rays, counted.counters.size());
    EXPECT_GT(totals.steps, totals.rays / 2);
}

TEST_F(Rendering, EveryStructureShowsTheSamePicture) {
    const Mesh mesh = test::joined(test::makeSphere(3), test::makeRandomTriangles(300, 4, 0.4f));
    const Atlas uniform = test::makeAtlas(mesh, kStructureUniform, {12, 12, 12});
    const FilmPixels expected = render(uniform, featuresOf(uniform)).pixels;
    const Atlas cloud = test::makeAtlas(mesh, kStructureCloud, {12, 12, 12});
    EXPECT_EQ(largestDifference(expected, render(cloud, featuresOf(cloud)).pixels), 0.0f);
    const Atlas nested = test::makeAtlas(mesh, kStructureNested, {12, 12, 12});
    EXPECT_EQ(largestDifference(expected, render(nested, featuresOf(nested)).pixels), 0.0f);
}

TEST_F(Rendering, WorkIsSummedIn64Bits) {
    const std::vector<glm::uvec4> counters(3, glm::uvec4(0xFFFFFFFFu, 0x80000000u, 1u, 0u));
    const WorkTotals totals = sumWork(counters);
    EXPECT_EQ(totals.rays, 3ull * 0xFFFFFFFFu);
    EXPECT_EQ(totals.steps, 3ull * 0x80000000u);
    EXPECT_EQ(totals.tests, 3u);
}

const ImageChannel& channel(const Image& image, const char* name) {
    return *image.find(name);
}

// p' = p M for a row vector p.
glm::vec4 transformed(const glm::dvec3& point, const std::vector<float>& matrix) {
    const double p[4] = {point.x, point.y, point.z, 1.0};
    glm::vec4 result(0.0f);
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 4; ++row)
            result[static_cast<int>(column)] += static_cast<float>(p[row] * matrix[row * 4 + column]);
    return result;
}

TEST_F(Rendering, ImageHoldsDepthNormalIdAndMatrices) {
    const Mesh mesh = test::moved(test::makeSphere(3), 2.0f, {10.0f, 20.0f, 30.0f});
    const Atlas atlas = test::makeAtlas(mesh, kStructureCloud, {16, 16, 16});
    const CameraPose pose = defaultPose(atlas);
    const FilmPixels pixels = render(atlas, featuresOf(atlas)).pixels;
    const Image image = toImage(kSize, pixels, {pose, 1, 2, "renderer", std::nullopt});
    const CameraBasis basis = basisOf(pose, double(kSize.x) / kSize.y);
    const glm::dvec3 centre(10, 20, 30);
    std::size_t hits = 0;
    for (unsigned y = 0; y < kSize.y; ++y)
        for (unsigned x = 0; x < kSize.x; ++x) {
            const std::size_t i = std::size_t(y) * kSize.x + x;
            const float depth = channel(image, "Z").values[i];
            if (channel(image, "id").uints[i] == kNoTriangle) {
                ASSERT_EQ(depth, 0.0f);
                ASSERT_EQ(channel(image, "A").values[i], 0.0f);
                ASSERT_EQ(channel(image, "G").values[i], 0.5f);
                continue;
            }
            ++hits;
            const glm::dvec2 ndc(2.0 * (x + 0.5) / kSize.x - 1.0, 1.0 - 2.0 * (y + 0.5) / kSize.y);
            const glm::dvec3 point =
                pose.eye + double(depth) * (basis.forward + basis.right * (basis.halfWidth * ndc.x) +
                                            basis.up * (basis.halfHeight * ndc.y));
            ASSERT_NEAR(glm::distance(point, centre), 2.0, 0.02);
            const glm::dvec3 normal(channel(image, "N.X").values[i], channel(image, "N.Y").values[i],
                                    channel(image, "N.Z").values[i]);
            ASSERT_GT(glm::dot(normal, (point - centre) / 2.0), 0.99);
            const glm::vec4 inCamera = transformed(point, image.matrices.at("worldToCamera"));
            ASSERT_NEAR(inCamera.z, depth, 1e-4f);
            const glm::vec4 clip = transformed(point, image.matrices.at("worldToNDC"));
            ASSERT_NEAR(clip.x / clip.w, (x + 0.5) / kSize.x, 1e-4);
            ASSERT_NEAR(clip.y / clip.w, (y + 0.5) / kSize.y, 1e-4);
            ASSERT_NEAR(clip.z / clip.w, 1.0f / depth, 1e-4f);
        }
    EXPECT_GT(hits, kSize.x * kSize.y / 10u);
    EXPECT_EQ(image.texts.at("rt:atlasHash"), "0000000000000002");
    EXPECT_EQ(image.floats.count("renderTimeSeconds"), 0u);
}

TEST(NonFinitePixels, AreCounted) {
    FilmPixels pixels{
        std::vector<glm::vec4>(4, glm::vec4(1.0f)), std::vector<glm::vec4>(4, glm::vec4(0.0f)), {0, 0, 0, 0}};
    pixels.variances = std::vector<float>(4, 0.0f);
    const auto count = [&](unsigned aovs) {
        RenderRecord record;
        record.camera.eye = glm::dvec3(0, 0, 1);
        record.aovs = aovs;
        return countNonFinite(toImage({2, 2}, pixels, record));
    };
    EXPECT_EQ(count(kAllAovs), 0u);
    pixels.variances[1] = INFINITY;
    EXPECT_EQ(count(kAovVariance), 1u);
    pixels.colors[1].g = std::nanf("");
    pixels.colors[2].b = -INFINITY;
    pixels.surfaces[3].w = INFINITY;
    EXPECT_EQ(count(kAovVariance | kAovDepth), 3u);
    EXPECT_EQ(count(0), 2u) << "of what is written";
}

} // namespace
} // namespace rt
