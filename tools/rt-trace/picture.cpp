#include "tools/rt-trace/picture.h"

#include "tools/rt-trace/checkpoint.h"
#include "tools/rt-trace/label_shard.h"
#include "tools/rt-trace/picture_files.h"
#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/warm_up.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

/// Takes the samples again with a variant that counts, and sees how long the parts of that take.
void countWork(const TraceOptions& options, const GpuScene& scene, const PictureSetup& setup,
               Picture& picture) {
    ResourcePlan plan = scene.plan;
    plan.features.countWork = 1;
    const GpuPrograms programs = compileVariant(plan, scene.shaderCache());
    const GlLimits& limits = scene.context->limits();
    const Film film(options.window, plan.features, limits);
    GpuView view(setup.camera, setup.params, setup.lights, plan.features, limits, scene.mostSamples);
    view.bind();
    film.bind();
    view.measure(picture.stageTimes);
    TileSamples tiles = picture.tiles;
    for (TileSamples::Tile& tile : tiles.tiles()) tile = {0, tile.samples};
    renderTiles(programs, view, film, *scene.context, tiles, {});
    picture.work = sumWork(film.readCounters(tiles.window()));
}

// Between checkpoints, or from the one that is resumed to the end.
void runLoop(const TraceOptions& options, const GpuScene& scene, GpuView& view, const Film& film,
             const PictureIdentity& identity, Picture& picture) {
    LoopControl control;
    control.targetError = options.targetError;
    if (options.timeLimitSeconds > 0.0) control.endMs = programMs() + options.timeLimitSeconds * 1e3;
    const auto save = [&](double gpuMs) {
        saveCheckpoint(options.checkpointPath, identity, film, picture.tiles, picture.earlierMs + gpuMs);
    };
    if (!options.checkpointPath.empty()) control.save = save;
    picture.figures = renderTiles(scene.programs, view, film, *scene.context, picture.tiles, control);
    picture.passes = view.passes();
    if (control.save) save(picture.figures.gpuMs);
}

// The same picture anew, warming up first; it stays as the last pass made it.
void repeatLoop(const TraceOptions& options, const GpuScene& scene, GpuView& view, const Film& film,
                Picture& picture) {
    const TileSamples untouched = picture.tiles;
    const LoopControl control{.targetError = options.targetError};
    const auto pass = [&] {
        picture.tiles = untouched;
        const PassCounts before = view.passes();
        picture.figures = renderTiles(scene.programs, view, film, *scene.context, picture.tiles, control);
        picture.passes = view.passes() - before;
    };
    warmUp(pass);
    for (unsigned i = 0; i < options.repeat; ++i) {
        pass();
        picture.passesMs.push_back(picture.figures.gpuMs);
    }
    std::sort(picture.passesMs.begin(), picture.passesMs.end());
    picture.figures.gpuMs = medianOf(picture.passesMs);
}

void requireWholePixels(const TraceOptions& options, const FilmPixels& pixels) {
    requireWholeWalks(
        static_cast<std::size_t>(std::count(pixels.ids.begin(), pixels.ids.end(), kWalkCutShort)), "pixels",
        options.scenePath);
}

} // namespace

Picture renderPicture(const TraceOptions& options, const GpuScene& scene, const PictureSetup& setup,
                      StageTimer& stages) {
    const GlContext& context = *scene.context;
    const Film film(options.window, scene.plan.features, context.limits());
    GpuView view(setup.camera, setup.params, setup.lights, scene.plan.features, context.limits(),
                 scene.mostSamples);
    const PictureIdentity identity = identityOf(options, setup, scene.plan.features, scene.file.contentHash);
    Picture picture{{}, TileSamples(options.window, options.range.count), {}, {}};
    if (!options.resumePath.empty())
        picture.earlierMs = resumeCheckpoint(options.resumePath, identity, film, picture.tiles);
    scene.atlas.bind();
    view.bind();
    film.bind();
    stages.begin("compile");
    finishCompiling(scene.programs, view);
    stages.end();
    stages.add("firstDispatch", programMs());
    stages.begin("render");
    if (options.repeat > 0)
        repeatLoop(options, scene, view, film, picture);
    else
        runLoop(options, scene, view, film, identity, picture);
    stages.begin("readback");
    picture.pixels = film.read(options.window, picture.tiles.perPixel());
    if (options.aovs & kAovMaterial)
        picture.pixels.materials = materialsOf(picture.pixels.ids, scene.file.atlas.triangleVertices);
    stages.end();
    requireWholePixels(options, picture.pixels);
    if (options.stats) countWork(options, scene, setup, picture);
    if (options.heat != Heat::None)
        picture.heatMost = paintHeat(picture.pixels, options.heat, options.heatMost);
    return picture;
}

Image imageOf(const Picture& picture, const TraceOptions& options, const GpuScene& scene,
              const PictureSetup& setup) {
    RenderRecord record{setup.pose, scene.file.atlas.info.meshHash, scene.file.contentHash,
                        scene.context->device().renderer, std::nullopt};
    if (!options.reproducible) record.renderTimeSeconds = (picture.earlierMs + picture.figures.gpuMs) * 1e-3;
    record.samples = picture.tiles.most();
    record.seed = options.seed;
    record.aovs = options.aovs;
    record.window = options.window;
    Image image = toImage(options.size, picture.pixels, record);
    if (options.shard) labelShard(image, options, setup, scene.plan.features, scene.file.contentHash);
    return image;
}

} // namespace rt
