// --kernel multipass: the same pictures, to the bit, as the compute shaders', and no passes for nothing.
#include "tests/gpu/scene_fixture.h"

namespace rt {
namespace {

using test::expectSame;
using test::glass;
using test::makeFloor;
using test::matt;
using test::metal;
using test::mirror;

constexpr glm::uvec2 kSize(19, 13); // no multiples of any block
constexpr unsigned kIterations = 8; // before the host asks whether there are rays left

// Matt, mirroring, clear and rough things that see each other.
Mesh room() {
    return test::joinedParts(
        {{makeFloor({-3, -3}, {3, 3}, -1.0f), matt(0.7f)},
         {test::moved(test::makeSphere(2), 0.8f, {-1.2f, 0, 0}), mirror(0.8f)},
         {test::moved(test::makeSphere(2), 0.8f, {0.7f, -0.4f, 0}), glass(1.5f)},
         {test::makeBox({0.5f, 1.2f, -1}, {1.5f, 2, 0.5f}), metal({0.9f, 0.7f, 0.3f}, 0.3f)}});
}

class Multipass : public test::OnGpu {
protected:
    static test::Shot shot() {
        test::Shot shot;
        shot.pose.eye = {0.5, -6, 2};
        shot.pose.lookAt = {0, 0, -0.2};
        shot.pose.up = {0, 0, 1};
        shot.pose.fovDegrees = 40.0;
        shot.size = kSize;
        shot.background = {0.2f, 0.3f, 0.5f};
        return shot;
    }
    static FilmPixels renderedBy(bool multipass, const Mesh& mesh, test::SceneSettings settings,
                                 const test::Shot& shot) {
        settings.multipass = multipass;
        return test::SceneOnGpu(*context, mesh, settings).render(shot);
    }
    // Returns the picture.
    static FilmPixels expectSamePicture(const Mesh& mesh, const test::SceneSettings& settings,
                                        const test::Shot& shot) {
        const FilmPixels expected = renderedBy(false, mesh, settings, shot);
        const FilmPixels passes = renderedBy(true, mesh, settings, shot);
        context->device().software ? expectSame(passes, expected)
                                   : test::expectSameOfTwoPrograms(passes, expected);
        return expected;
    }
    static test::SceneSettings lit() {
        test::SceneSettings settings;
        settings.lights = {pointLight({2, -3, 4}, glm::vec3(40.0f)),
                           pointLight({-3, -2, 3}, glm::vec3(20.0f))};
        settings.ambient = 0.1f;
        settings.maxDepth = 3;
        return settings;
    }
};

std::size_t hitsIn(const FilmPixels& pixels) {
    return pixels.ids.size() -
           static_cast<std::size_t>(std::count(pixels.ids.begin(), pixels.ids.end(), kNoTriangle));
}

TEST_F(Multipass, ShowsTheSameInEveryStructure) {
    test::SceneSettings settings = lit();
    settings.aovs = true;
    for (const std::uint32_t structure :
         {kStructureUniform, kStructureCloud, kStructureOctant, kStructureNested}) {
        settings.structure = structure;
        const FilmPixels picture = expectSamePicture(room(), settings, shot());
        EXPECT_GT(hitsIn(picture), picture.ids.size() / 2);
        EXPECT_LT(hitsIn(picture), picture.ids.size());
    }
}

TEST_F(Multipass, ShowsTheSameOfEveryView) {
    for (const std::uint32_t view : {kOrthographicView, kPanoramaView}) {
        test::SceneSettings settings = lit();
        settings.view = view;
        test::Shot other = shot();
        other.pose.view = view;
        other.pose.height = 5.0;
        if (view == kPanoramaView) other.pose.eye = {0.2, -1.5, 0.5};
        EXPECT_GT(hitsIn(expectSamePicture(room(), settings, other)), 0u);
    }
}

TEST_F(Multipass, AddsUpTheSameSamples) {
    test::SceneSettings settings = lit();
    settings.environment = test::evenEnvironment({0.4f, 0.5f, 0.7f});
    settings.lens = settings.multisample = settings.aovs = true;
    settings.maxDepth = 2;
    test::Shot several = shot();
    several.pose.lensRadius = 0.05;
    several.pose.focusDistance = 6.0;
    several.size = {11, 7};
    several.samples = 5;
    several.samplesPerDispatch = 3;
    several.filterRadius = 1.0f;
    several.filter = kFilterTent;
    const FilmPixels picture = expectSamePicture(room(), settings, several);
    EXPECT_GT(*std::max_element(picture.variances.begin(), picture.variances.end()), 0.0f);
}

TEST_F(Multipass, ShowsTheSameTextures) {
    Mesh mesh = test::makeTexturedSquare({{16, 16}, {8, 8}});
    std::vector<std::uint32_t> pixels(mesh.pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = static_cast<std::uint32_t>(i * 2654435761u) | (i % 3 == 0 ? 0u : 0xFF000000u);
    mesh.pixels = std::move(pixels);
    for (const float cutOut : {0.0f, 0.5f}) { // veils, or holes
        Material material = mesh.materials[0];
        material.more.y = kMaterialClear;
        material.transmission.w = cutOut;
        mesh.materials = std::vector<Material>{material};
        test::Shot close = shot();
        close.pose.eye = {0.6, 0.4, 1.5};
        close.pose.lookAt = {0.5, 0.5, 0};
        close.pose.up = {0, 1, 0};
        EXPECT_GT(hitsIn(expectSamePicture(mesh, lit(), close)), 30u);
    }
}

TEST_F(Multipass, DoesOnePixel) {
    test::Shot one = shot();
    one.size = {1, 1};
    EXPECT_EQ(hitsIn(expectSamePicture(room(), lit(), one)), 1u);
}

TEST_F(Multipass, TakesNoMemoryForRounds) {
    const auto beside = [](unsigned multipass) { // per slot
        constexpr std::uint64_t kSlots = 4096;
        SceneFeatures features;
        features.multipass = multipass;
        return SampleSlots::bytesFor(features, limits(), kSlots) / kSlots - slotLayout(features).bytes();
    };
    EXPECT_EQ(beside(0), 8u) << "two queues";
    EXPECT_EQ(beside(1), 0u);
}

// Two sheets far apart in a row of voxels, as a camera sees them that looks along the row.
class LongRow : public Multipass {
protected:
    static constexpr unsigned kVoxels = 700;
    static Mesh sheets() {
        return test::joined(test::makeTriangles({{-0.9f, -1, 0}, {-0.7f, -1, 0}, {-0.8f, -0.9f, 0}}),
                            test::makeTriangles({{-1, -1, -100}, {1, -1, -100}, {0, 1, -100}}));
    }

    struct Result {
        test::Picture picture;
        PassCounts passes;
        std::uint64_t mostSteps = 0; ///< of a pixel's rays together
    };
    static Result render(std::uint32_t structure, bool multipass, glm::uvec2 size, std::uint64_t mostSamples,
                         double lookAtZ = -100.0) {
        const Atlas atlas = test::makeAtlas(sheets(), structure, {1, 1, kVoxels});
        CameraPose pose;
        pose.eye = {0, 0, 5};
        pose.lookAt = {0, 0, lookAtZ};
        pose.up = {0, 1, 0};
        pose.fovDegrees = 2.0;
        SceneFeatures features = renderFeatures(atlas, {.maxDepth = 0, .multipass = multipass});
        features.software = context->device().software;
        features.countWork = 1;
        const ResourcePlan plan =
            planResources(atlas, features, ShaderKind::Render, limits().fragmentResources, "atlas");
        const GpuAtlas gpuAtlas = uploadAtlas(atlas, plan, limits(), 0, "atlas");
        const GpuPrograms programs = compileVariant(plan);
        GpuView view(cameraInAtlas(pose, double(size.x) / size.y, atlas.grid), wholePicture(size), {},
                     features, limits(), mostSamples);
        const Film film({0, 0, size}, features, limits());
        gpuAtlas.bind();
        view.bind();
        film.bind();
        finishCompiling(programs, view);
        EXPECT_EQ(view.passes().shade, 0u) << "a warm-up is no rendering";
        Result result;
        result.picture.pixels = test::renderOneSample(programs, view, film, *context, size);
        result.picture.counters = film.readCounters({0, 0, size});
        result.passes = view.passes();
        for (const glm::uvec4& work : result.picture.counters)
            result.mostSteps = std::max<std::uint64_t>(result.mostSteps, work.y);
        return result;
    }
};

TEST_F(LongRow, PassesGoOnUntilTheLastRayHasEnded) {
    const Result expected = render(kStructureUniform, false, {5, 3}, 1 << 20);
    const Result passes = render(kStructureUniform, true, {5, 3}, 1 << 20);
    expectSame(passes.picture.pixels, expected.picture.pixels);
    EXPECT_EQ(passes.picture.counters, expected.picture.counters);
    EXPECT_EQ(passes.picture.pixels.ids[7], 1u) << "the far sheet";
    EXPECT_EQ(passes.mostSteps, kVoxels);
    // The last step is shaded with it; the pixel rests in one more iteration, and the host asks after each
    // eighth.
    EXPECT_GE(passes.passes.traverse, kVoxels + 1);
    EXPECT_LE(passes.passes.traverse, kVoxels + 2 + kIterations);
    EXPECT_EQ(passes.passes.intersect, passes.passes.traverse);
    EXPECT_EQ(passes.passes.shade, passes.passes.traverse + 2) << "begun before, added up behind";
}

TEST_F(LongRow, ACloudNeedsFewPasses) {
    const Result passes = render(kStructureCloud, true, {5, 3}, 1 << 20);
    EXPECT_EQ(passes.picture.pixels.ids[7], 1u);
    EXPECT_LE(passes.passes.traverse, 4 * kIterations);
}

TEST_F(LongRow, NothingInViewIsSeenAfterOneGroupOfPasses) {
    const Result passes = render(kStructureUniform, true, kSize, 1 << 20, 100.0);
    EXPECT_EQ(hitsIn(passes.picture.pixels), 0u);
    EXPECT_EQ(passes.passes.traverse, kIterations);
}

TEST_F(LongRow, RegionsThatFitTheRoomGiveTheSamePicture) {
    const Result whole = render(kStructureCloud, true, kSize, 1 << 20);
    const Result parts = render(kStructureCloud, true, kSize, 1); // of 128 samples each
    expectSame(parts.picture.pixels, whole.picture.pixels);
    EXPECT_EQ(parts.picture.counters, whole.picture.counters);
    EXPECT_GT(parts.passes.shade, whole.passes.shade);
}

} // namespace
} // namespace rt
