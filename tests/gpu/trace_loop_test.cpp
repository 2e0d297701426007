// The render loop: a picture does not depend on how its work is cut, or on where it was interrupted.
#include "tests/gpu/render_fixture.h"
#include "tools/rt-trace/render_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rt {
namespace {

using test::expectSame;
using test::makeAtlas;

constexpr glm::uvec2 kSize(100, 70);
constexpr std::uint32_t kSamples = 5;

/// A scene on the device with all that samples need.
class SampledScene {
public:
    explicit SampledScene(const GlContext& context)
        : context_(context), atlas_(makeAtlas(test::makeSphere(3), kStructureCloud, {12, 12, 12})),
          pose_(placeCamera({}, test::boundsOfAtlas(atlas_), aspect())),
          lights_(chooseLights({}, atlas_, test::boundsOfAtlas(atlas_), pose_)),
          plan_(planResources(atlas_, features(), ShaderKind::Render, context.limits().resources, "atlas")),
          gpuAtlas_(
              uploadAtlas(atlas_, plan_, context.limits(), static_cast<unsigned>(lights_.size()), "atlas")),
          programs_(compileVariant(plan_)) {}

    Film film(const glm::uvec4& window = {0, 0, kSize}) const {
        return Film(window, plan_.features, context_.limits());
    }

    LoopFigures run(const Film& film, TileSamples& tiles, const LoopControl& control) const {
        RenderParams params = wholePicture(kSize);
        params.size = {kSize, tiles.window().x, tiles.window().y};
        params.background = glm::vec4(0.25f, 0.5f, 0.75f, 0.0f);
        params.samples = {0, kSamples, 7, kFilterTent};
        params.filterSize.x = 1.0f;
        GpuView view(cameraInAtlas(pose_, aspect(), atlas_.grid), params, lights_, plan_.features,
                     context_.limits());
        gpuAtlas_.bind();
        view.bind();
        film.bind();
        return renderTiles(programs_, view, film, context_, tiles, control);
    }

    FilmPixels render(const glm::uvec4& window, std::uint64_t mostSamples, LoopFigures& figures) const {
        const Film picture = film(window);
        TileSamples tiles(window, kSamples);
        LoopControl control;
        control.mostSamples = mostSamples;
        figures = run(picture, tiles, control);
        return picture.read(window, tiles.perPixel());
    }

private:
    static double aspect() { return double(kSize.x) / kSize.y; }
    SceneFeatures features() const {
        SceneFeatures features = renderFeatures(
            atlas_, {.maxDepth = 4, .lights = lights_, .multisample = true, .aovs = true, .moments = true});
        features.software = context_.device().software;
        return features;
    }

    const GlContext& context_;
    Atlas atlas_;
    CameraPose pose_;
    std::vector<Light> lights_;
    ResourcePlan plan_;
    GpuAtlas gpuAtlas_;
    GpuPrograms programs_;
};

class RenderLoop : public testing::Test {
protected:
    std::unique_ptr<GlContext> context = GlContext::open({});
    SampledScene scene{*context};
};

TEST_F(RenderLoop, ThePictureIsTheSameHoweverItIsCut) {
    LoopFigures whole, pieces;
    const FilmPixels expected = scene.render({0, 0, kSize}, 1u << 30, whole);
    EXPECT_EQ(whole.samples, std::uint64_t(kSamples) * kSize.x * kSize.y);
    for (const std::uint64_t mostSamples : {1ull, 2100ull, 9000ull}) {
        expectSame(scene.render({0, 0, kSize}, mostSamples, pieces), expected);
        EXPECT_GT(pieces.dispatches, whole.dispatches);
    }
    EXPECT_GT(expected.colors[50 + 35 * kSize.x].g, 0.0f);
}

TEST_F(RenderLoop, ACropIsAPartOfTheWholePicture) {
    LoopFigures figures;
    const FilmPixels whole = scene.render({0, 0, kSize}, 1u << 30, figures);
    const glm::uvec4 window(13, 20, 77, 61);
    const FilmPixels part = scene.render(window, 5000, figures);
    ASSERT_EQ(part.colors.size(), 64u * 41u);
    for (unsigned y = window.y; y < window.w; ++y)
        for (unsigned x = window.x; x < window.z; ++x) {
            const std::size_t i = std::size_t(y - window.y) * 64 + (x - window.x);
            ASSERT_EQ(part.colors[i], whole.colors[y * kSize.x + x]) << x << "," << y;
            ASSERT_EQ(part.ids[i], whole.ids[y * kSize.x + x]);
        }
}

TEST_F(RenderLoop, GoesOnFromASavedFilm) {
    LoopFigures figures;
    const glm::uvec4 window(0, 0, kSize);
    const FilmPixels expected = scene.render(window, 1u << 30, figures);
    const Film first = scene.film();
    TileSamples tiles(window, 2);
    tiles.tiles()[3].goal = 1; // tiles need not be as far as others
    scene.run(first, tiles, {});
    for (TileSamples::Tile& tile : tiles.tiles()) tile.goal = kSamples;
    const Film second = scene.film();
    ASSERT_TRUE(second.restore(window, first.save(window)));
    scene.run(second, tiles, {});
    expectSame(second.read(window, tiles.perPixel()), expected);
}

TEST_F(RenderLoop, PlanesOfOtherPicturesAreNotTaken) {
    const Film film = scene.film();
    std::vector<CheckpointPlane> planes = film.save({0, 0, kSize});
    EXPECT_FALSE(film.restore({0, 0, 99, 70}, planes));
    planes.pop_back();
    EXPECT_FALSE(film.restore({0, 0, kSize}, planes));
}

TEST_F(RenderLoop, EndsAtTheTimeLimitWithOneSampleAtLeast) {
    const Film film = scene.film();
    TileSamples tiles({0, 0, kSize}, 1u << 20);
    LoopControl control;
    control.endMs = 1e-3; // long ago
    control.mostSamples = 3000;
    const LoopFigures figures = scene.run(film, tiles, control);
    EXPECT_TRUE(figures.timeLimitReached);
    EXPECT_EQ(tiles.least(), 1u);
    EXPECT_EQ(tiles.most(), 1u);
}

TEST_F(RenderLoop, TilesThatAreGoodEnoughAreNotDispatchedAgain) {
    const Film film = scene.film();
    TileSamples tiles({0, 0, kSize}, 64);
    LoopControl control;
    control.targetError = 1e6;
    const LoopFigures figures = scene.run(film, tiles, control);
    EXPECT_EQ(figures.tilesStopped, tiles.tiles().size());
    EXPECT_EQ(tiles.most(), 16u);
    EXPECT_FALSE(tiles.nextRound());
}

} // namespace
} // namespace rt
