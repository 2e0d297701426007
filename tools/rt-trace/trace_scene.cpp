#include "tools/rt-trace/trace_scene.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/camera_path.h"
#include "tools/rt-trace/explain.h"
#include "tools/rt-trace/picture.h"
#include "tools/rt-trace/picture_files.h"
#include "tools/rt-trace/render_image.h"
#include "tools/rt-trace/report.h"
#include "tools/rt-trace/turntable.h"
#include "tools/rt-trace/upload_environment.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

/// Renders and writes what the options' outputs name. Returns its figures.
nlohmann::json makePicture(const TraceOptions& options, const TraceRecipes& recipes, const GpuScene& scene,
                           const PictureSetup& setup, StageTimer& stages) {
    Picture picture = renderPicture(options, scene, setup, stages);
    const bool heat = options.heat != Heat::None; // its colours are what they are
    stages.begin("write");
    Image image = imageOf(picture, options, scene, setup);
    addRecipes(image, recipes);
    picture.nonFinite = countNonFinite(image);
    writePictures(options.outputPaths, image, heat ? ToneMap::None : options.toneMap,
                  heat ? 0.0 : options.exposureStops, recipes.own);
    stages.end();
    logPicture(picture, options);
    return figuresOf(picture, options, setup);
}

/// Before the first frame is rendered: throws Error{InvalidContent} if one has a camera that sees nothing.
void checkPath(const TraceOptions& options, const std::vector<CameraKey>& path) {
    for (unsigned frame = options.frames->first; frame <= options.frames->last; ++frame) try {
            placeCamera(cameraAt(path, frame, options.camera), {glm::dvec3(-1.0), glm::dvec3(1.0)}, 1.0);
        } catch (const Error& error) {
            const std::string& source = options.cameraPath.empty() ? options.scenePath : options.cameraPath;
            throw Error(ErrorKind::InvalidContent,
                        fmt::format("{}: frame {}: {}", source, frame, error.what()));
        }
}

CameraRequest cameraOfFrame(const TraceOptions& options, const std::vector<CameraKey>& path,
                            const CameraPose& first, unsigned frame) {
    if (options.turntable == 0) return cameraAt(path, frame, options.camera);
    return turnedCamera(first, 360.0 * (frame - 1.0) / options.turntable, options.camera);
}

nlohmann::json makeFrames(const TraceOptions& options, const TraceRecipes& recipes,
                          const std::vector<CameraKey>& path, const GpuScene& scene, PictureSetup& setup,
                          StageTimer& stages) {
    nlohmann::json frames = nlohmann::json::array();
    const CameraPose first = setup.pose;
    for (unsigned frame = options.frames->first; frame <= options.frames->last; ++frame) {
        TraceOptions ofFrame = options;
        for (std::string& output : ofFrame.outputPaths) output = framePath(output, frame).value_or(output);
        moveCamera(setup, cameraOfFrame(options, path, first, frame), options, scene.file.atlas);
        logInfo(fmt::format("frame {}", frame));
        frames.push_back(makePicture(ofFrame, recipesOfFrame(recipes, frame), scene, setup, stages));
        frames.back()["frame"] = frame;
    }
    return frames;
}

// Stays bound for all pictures. Nothing where there is none.
std::optional<GpuEnvironment> uploadEnvironment(const TraceOptions& options, const PictureSetup& setup,
                                                const GpuScene& scene) {
    if (setup.environment.pixels.empty()) return std::nullopt;
    std::optional<GpuEnvironment> environment;
    const bool isOwn = options.environment.empty();
    environment.emplace(setup.environment, scene.context->limits(),
                        isOwn ? options.scenePath + "'s environment" : options.environment);
    environment->bind();
    return environment;
}

// --stats makes a film of its own, beside the first.
std::vector<MemoryNeed> memoryOf(const TraceOptions& options, const PictureSetup& setup,
                                 const SceneFeatures& features) {
    SceneFeatures counting = features;
    counting.countWork = 1;
    const std::uint64_t counted = options.stats ? Film::bytesFor(options.window, counting) : 0;
    const glm::uvec2 size(options.window.z - options.window.x, options.window.w - options.window.y);
    const std::uint64_t rays = features.multipass ? RayPasses::bytesFor(size) * (options.stats ? 2 : 1) : 0;
    return {{"the picture", Film::bytesFor(options.window, features) + counted, "lower --size or use --crop"},
            {"the rays in textures", rays, "lower --size or use --crop"},
            {"the environment", GpuEnvironment::bytesFor(setup.environment), "scale --environment down"}};
}

void requireClock(const PictureNeeds& needs, const GlLimits& limits) {
    if (needs.time && !limits.shaderClock)
        throw Error(ErrorKind::NoGpu, "the device has no clock that shaders can read (GL_ARB_shader_clock), "
                                      "as --heat time and --aov time need; use another --device");
}

// `figures`: what there is to say beside the scene.
void report(const TraceOptions& options, const TraceRecipes& recipes, const GpuScene& scene,
            const StageTimer& stages, const nlohmann::json& figures) {
    if (options.common.jsonPath.empty()) return;
    nlohmann::json report = figures;
    reportCommon(report, scene, stages);
    reportSections(report, scene, options.environment.empty());
    writeReport(options.common.jsonPath, report, recipeOfReport(options, recipes.own));
}

} // namespace

void traceScene(const TraceOptions& given, const TraceRecipes& recipes) {
    StageTimer stages;
    TraceOptions options = given;
    std::vector<CameraKey> path;
    const auto startPath = [&](std::vector<CameraKey> keys) {
        path = std::move(keys);
        checkPath(options, path);
        options.camera =
            cameraAt(path, path.front().frame, options.camera); // lights stay, whichever frames are asked for
    };
    if (options.frames && !options.cameraPath.empty()) startPath(readCameraPath(options.cameraPath));
    PictureSetup setup;
    const auto choose = [&](const Atlas& atlas, const GlLimits& limits) -> SceneNeeds {
        if (options.frames && options.turntable == 0 && path.empty())
            startPath(pathOfCamera(options.camera.name, atlas.cameras, atlas.cameraKeys));
        setup = setUpPicture(options, atlas);
        const PictureNeeds needs = needsOf(options, setup);
        requireClock(needs, limits);
        const SceneFeatures features = renderFeatures(atlas, needs);
        return {features, static_cast<unsigned>(setup.lights.size()), memoryOf(options, setup, features),
                samplesToTrace(options.window, options.range.count)};
    };
    const GpuScene scene = loadScene(options, ShaderKind::Render, choose, stages);
    if (options.explain && options.common.jsonPath != "-")
        writeFile("-", explanation(scene.file.atlas, scene.plan, options.environment.empty()));
    if (options.outputPaths.empty()) return report(options, recipes, scene, stages, {});
    const std::optional<GpuEnvironment> environment = uploadEnvironment(options, setup, scene);
    nlohmann::json figures;
    if (options.frames)
        figures["frames"] = makeFrames(options, recipes, path, scene, setup, stages);
    else
        figures = makePicture(options, recipes, scene, setup, stages);
    logStages(stages);
    report(options, recipes, scene, stages, figures);
}

} // namespace rt
