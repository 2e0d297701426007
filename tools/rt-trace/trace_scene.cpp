#include "tools/rt-trace/trace_scene.h"

#include "common/binary_io.h"
#include "common/json_file.h"
#include "common/log.h"
#include "tools/rt-trace/load_scene.h"
#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/shader_variant.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

BoundsD sceneBounds(const AtlasInfo& info) {
    return {{info.worldLo[0], info.worldLo[1], info.worldLo[2]},
            {info.worldHi[0], info.worldHi[1], info.worldHi[2]}};
}

RenderParams renderParams(const TraceOptions& options) {
    RenderParams params = wholePicture(options.size);
    params.background = glm::vec4(options.background, 0.0f);
    params.ambient = glm::vec4(options.ambient, 0.0f);
    return params;
}

/// Renders again with a variant that counts.
WorkTotals countRenderWork(const TraceOptions& options, ResourcePlan plan, const GlContext& context,
                           const GpuView& view) {
    plan.features.countWork = 1;
    const GlProgram program = compileVariant(plan);
    const Film film(options.size, true, context.limits());
    film.bind();
    renderRows(program, view, context);
    return sumWork(film.readCounters());
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
    const CameraPose pose = placeCamera(options.camera, bounds, aspect);
    return {pose, cameraInAtlas(pose, aspect, atlas.grid), renderParams(options),
            chooseLights(options.lights, atlas, bounds, pose)};
}

struct Rendered {
    FilmPixels pixels;
    double gpuMs = 0.0;
    std::optional<WorkTotals> work;
};

Rendered render(const TraceOptions& options, const GpuScene& scene, const Scenery& scenery,
                StageTimer& stages) {
    const GlContext& context = *scene.context;
    const Film film(options.size, false, context.limits());
    const GpuView view(scenery.camera, scenery.params, scenery.lights);
    scene.atlas.bind();
    view.bind();
    film.bind();
    stages.begin("compile");
    finishCompiling(scene.program, view);
    stages.end();
    stages.add("firstDispatch", programMs());
    Rendered rendered;
    rendered.gpuMs = renderRows(scene.program, view, context);
    stages.begin("readback");
    rendered.pixels = film.read();
    stages.end();
    const std::vector<std::uint32_t>& ids = rendered.pixels.ids;
    requireWholeWalks(static_cast<std::size_t>(std::count(ids.begin(), ids.end(), kWalkCutShort)), "pixels",
                      options.scenePath);
    if (options.stats) rendered.work = countRenderWork(options, scene.plan, context, view);
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

void logFigures(const TraceOptions& options, const Rendered& rendered) {
    std::string figures = fmt::format("{}x{} in {:.2f} ms", options.size.x, options.size.y, rendered.gpuMs);
    if (const auto& work = rendered.work)
        figures +=
            fmt::format(", {} rays, {:.1f} Mrays/s, {:.2f} steps and {:.2f} tests per ray", work->rays,
                        mraysPerSecond(work->rays, rendered.gpuMs), double(work->steps) / double(work->rays),
                        double(work->tests) / double(work->rays));
    logInfo(figures);
}

void writeReport(const TraceOptions& options, const GpuScene& scene, const CameraPose& pose,
                 const Rendered& rendered, const StageTimer& stages) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report;
    reportCommon(report, scene, stages);
    reportCamera(report, pose);
    report["width"] = options.size.x;
    report["height"] = options.size.y;
    report["gpuMs"] = rendered.gpuMs;
    if (rendered.work) {
        reportWork(report, *rendered.work, rendered.gpuMs);
        report["selfHits"] = rendered.work->selfHits;
    }
    writeJson(options.common.jsonPath, report);
}

} // namespace

void traceScene(const TraceOptions& options) {
    StageTimer stages;
    Scenery scenery;
    const auto choose = [&](const Atlas& atlas, const GlLimits&) -> SceneNeeds {
        scenery = chooseScenery(options, atlas);
        return {renderFeatures(atlas, {.maxDepth = options.maxDepth, .lights = scenery.lights}),
                static_cast<unsigned>(scenery.lights.size())};
    };
    const GpuScene scene = loadScene(options, ShaderKind::Render, choose, stages);
    const Rendered rendered = render(options, scene, scenery, stages);
    warnOfNonFinite(options, rendered.pixels);
    RenderRecord record{scenery.pose, scene.file.atlas.info.meshHash, scene.file.contentHash,
                        scene.context->device().renderer, std::nullopt};
    if (!options.reproducible) record.renderTimeSeconds = rendered.gpuMs * 1e-3;
    stages.begin("write");
    writeImages(options.outputPaths, toImage(options.size, rendered.pixels, record));
    stages.end();
    logFigures(options, rendered);
    logStages(stages);
    writeReport(options, scene, scenery.pose, rendered, stages);
}

} // namespace rt
