#include "tools/rt-trace/trace_scene.h"

#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "tools/rt-trace/load_scene.h"
#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/render_loop.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/upload_environment.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

BoundsD sceneBounds(const AtlasInfo& info) {
    return {{info.worldLo[0], info.worldLo[1], info.worldLo[2]},
            {info.worldHi[0], info.worldHi[1], info.worldHi[2]}};
}

RenderParams renderParams(const TraceOptions& options, const GridParams& grid) {
    RenderParams params = wholePicture(options.size);
    params.background = glm::vec4(options.background, 0.0f);
    params.ambient =
        glm::vec4(options.ambient, static_cast<float>(options.occlusion * double(grid.worldOffset.w)));
    params.environment = glm::vec4(glm::vec3(static_cast<float>(options.environmentStrength)),
                                   static_cast<float>(options.environmentTurn / 360.0));
    params.filterSize.x = static_cast<float>(options.filterRadius);
    params.region = options.window;
    params.samples = {0, options.samples, options.seed, options.filter};
    return params;
}

/// Where the picture is taken from, and in which light.
struct Scenery {
    CameraPose pose;
    CameraParams camera;
    RenderParams params;
    std::vector<Light> lights;
};

Scenery chooseScenery(const TraceOptions& options, const Atlas& atlas) {
    const BoundsD bounds = sceneBounds(atlas.info);
    const double aspect = double(options.size.x) / options.size.y;
    const CameraPose pose = placeCamera(withNamedCamera(options.camera, atlas.cameras), bounds, aspect);
    return {pose, cameraInAtlas(pose, aspect, atlas.grid), renderParams(options, atlas.grid),
            chooseLights(options.lights, atlas, bounds, pose)};
}

PictureNeeds needsOf(const TraceOptions& options, const Scenery& scenery) {
    PictureNeeds needs;
    needs.maxDepth = options.maxDepth;
    needs.lights = scenery.lights;
    needs.environment = !options.environment.empty();
    needs.occlusion = options.occlusion > 0.0;
    needs.view = scenery.pose.view;
    needs.lens = scenery.pose.lensRadius > 0.0;
    needs.multisample = options.samples > 1;
    needs.aovs = (options.aovs & kExtraAovs) != 0 || options.heat != Heat::None;
    needs.moments = (options.aovs & kAovVariance) != 0 || options.targetError > 0.0;
    return needs;
}

std::optional<GpuEnvironment> uploadEnvironment(const TraceOptions& options, const GlLimits& limits) {
    if (options.environment.empty()) return std::nullopt;
    std::optional<GpuEnvironment> environment;
    environment.emplace(loadEnvironment(options.environment), limits, options.environment);
    environment->bind();
    return environment;
}

/// Takes the samples of `tiles` again with a variant that counts.
WorkTotals countWork(const TraceOptions& options, ResourcePlan plan, const GlContext& context,
                     const GpuView& view, const TileSamples& rendered) {
    plan.features.countWork = 1;
    const GlProgram program = compileVariant(plan);
    const Film film(options.size, plan.features, context.limits());
    film.bind();
    TileSamples tiles = rendered;
    for (TileSamples::Tile& tile : tiles.tiles()) tile = {0, tile.samples};
    WorkTotals totals;
    LoopControl control;
    control.afterDispatch = [&](const TileSamples::Region& region) {
        totals += sumWork(film.readCounters(region.pixels));
    };
    renderTiles(program, view, film, context, tiles, control);
    return totals;
}

struct Rendered {
    FilmPixels pixels;
    TileSamples tiles;
    LoopFigures figures;
    std::optional<WorkTotals> work;
};

Rendered render(const TraceOptions& options, const GpuScene& scene, const Scenery& scenery,
                StageTimer& stages) {
    const GlContext& context = *scene.context;
    const Film film(options.size, scene.plan.features, context.limits());
    const GpuView view(scenery.camera, scenery.params, scenery.lights);
    scene.atlas.bind();
    view.bind();
    film.bind();
    const std::optional<GpuEnvironment> environment = uploadEnvironment(options, context.limits());
    stages.begin("compile");
    finishCompiling(scene.program, view);
    stages.end();
    stages.add("firstDispatch", programMs());
    Rendered rendered{{}, TileSamples(options.window, options.samples), {}, {}};
    LoopControl control;
    control.targetError = options.targetError;
    if (options.timeLimitSeconds > 0.0) control.endMs = programMs() + options.timeLimitSeconds * 1e3;
    stages.begin("render");
    rendered.figures = renderTiles(scene.program, view, film, context, rendered.tiles, control);
    stages.begin("readback");
    rendered.pixels = film.read(options.window, rendered.tiles.perPixel());
    stages.end();
    const std::vector<std::uint32_t>& ids = rendered.pixels.ids;
    requireWholeWalks(static_cast<std::size_t>(std::count(ids.begin(), ids.end(), kWalkCutShort)), "pixels",
                      options.scenePath);
    if (options.stats) rendered.work = countWork(options, scene.plan, context, view, rendered.tiles);
    return rendered;
}

// A PNG is for looking at: its viewers would hide the background where nothing was hit.
Image withoutAlpha(Image image) {
    std::erase_if(image.channels, [](const ImageChannel& channel) { return channel.name == "A"; });
    return image;
}

// All are encoded before the first is written: a picture that cannot be encoded leaves no other one behind.
void writeImages(const std::vector<std::string>& paths, const Image& image) {
    std::vector<std::vector<std::byte>> files;
    for (const std::string& path : paths)
        files.push_back(
            encodeImage(path, imageFileType(path) == ImageFileType::Png ? withoutAlpha(image) : image));
    for (std::size_t i = 0; i < paths.size(); ++i) writeFile(paths[i], files[i]);
}

void warnOfNonFinite(const TraceOptions& options, const FilmPixels& pixels) {
    if (const std::size_t count = countNonFinite(pixels))
        logWarning(fmt::format("{}: {} pixels are not finite", options.scenePath, count));
}

double meanSamples(const Rendered& rendered) {
    double sum = 0.0;
    for (const std::uint32_t samples : rendered.tiles.perPixel()) sum += samples;
    return sum / static_cast<double>(rendered.tiles.pixelCount());
}

std::uint32_t mostSamples(const Rendered& rendered) {
    std::uint32_t most = 0;
    for (const TileSamples::Tile& tile : rendered.tiles.tiles()) most = std::max(most, tile.samples);
    return most;
}

void logFigures(const TraceOptions& options, const Rendered& rendered) {
    const glm::uvec4& window = options.window;
    const double gpuMs = rendered.figures.gpuMs;
    std::string figures = fmt::format("{}x{} in {:.2f} ms", window.z - window.x, window.w - window.y, gpuMs);
    if (options.samples > 1) figures += fmt::format(", {:.4g} samples per pixel", meanSamples(rendered));
    if (rendered.figures.timeLimitReached) figures += ", ended by --time-limit";
    if (const auto& work = rendered.work)
        figures += fmt::format(", {} rays, {:.1f} Mrays/s, {:.2f} steps and {:.2f} tests per ray", work->rays,
                               mraysPerSecond(work->rays, gpuMs), double(work->steps) / double(work->rays),
                               double(work->tests) / double(work->rays));
    logInfo(figures);
}

nlohmann::json samplesToJson(const TraceOptions& options, const Rendered& rendered) {
    std::uint32_t least = options.samples;
    for (const TileSamples::Tile& tile : rendered.tiles.tiles()) least = std::min(least, tile.samples);
    return {{"wanted", options.samples},
            {"least", least},
            {"most", mostSamples(rendered)},
            {"mean", meanSamples(rendered)},
            {"total", rendered.figures.samples},
            {"seed", options.seed},
            {"timeLimitReached", rendered.figures.timeLimitReached},
            {"dispatches", rendered.figures.dispatches},
            {"tiles", rendered.tiles.tiles().size()},
            {"tilesStoppedByError", rendered.figures.tilesStopped}};
}

void writeReport(const TraceOptions& options, const GpuScene& scene, const CameraPose& pose,
                 const Rendered& rendered, const StageTimer& stages) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report;
    reportCommon(report, scene, stages);
    reportCamera(report, pose);
    report["width"] = options.window.z - options.window.x;
    report["height"] = options.window.w - options.window.y;
    report["gpuMs"] = rendered.figures.gpuMs;
    report["samples"] = samplesToJson(options, rendered);
    if (rendered.work) {
        reportWork(report, *rendered.work, rendered.figures.gpuMs);
        report["selfHits"] = rendered.work->selfHits;
    }
    writeJson(options.common.jsonPath, report);
}

RenderRecord recordOf(const TraceOptions& options, const GpuScene& scene, const CameraPose& pose,
                      const Rendered& rendered) {
    RenderRecord record{pose, scene.file.atlas.info.meshHash, scene.file.contentHash,
                        scene.context->device().renderer, std::nullopt};
    if (!options.reproducible) record.renderTimeSeconds = rendered.figures.gpuMs * 1e-3;
    record.samples = mostSamples(rendered);
    record.seed = options.seed;
    record.aovs = options.aovs;
    record.window = options.window;
    return record;
}

} // namespace

void traceScene(const TraceOptions& options) {
    StageTimer stages;
    Scenery scenery;
    const auto choose = [&](const Atlas& atlas, const GlLimits&) -> SceneNeeds {
        scenery = chooseScenery(options, atlas);
        return {renderFeatures(atlas, needsOf(options, scenery)),
                static_cast<unsigned>(scenery.lights.size())};
    };
    const GpuScene scene = loadScene(options, ShaderKind::Render, choose, stages);
    const Rendered rendered = render(options, scene, scenery, stages);
    warnOfNonFinite(options, rendered.pixels);
    stages.begin("write");
    writeImages(options.outputPaths,
                toImage(options.size, rendered.pixels, recordOf(options, scene, scenery.pose, rendered)));
    stages.end();
    logFigures(options, rendered);
    logStages(stages);
    writeReport(options, scene, scenery.pose, rendered, stages);
}

} // namespace rt
