#include "tools/rt-trace/trace_scene.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/camera_path.h"
#include "tools/rt-trace/explain.h"
#include "tools/rt-trace/picture.h"
#include "tools/rt-trace/picture_files.h"
#include "tools/rt-trace/picture_options.h"
#include "tools/rt-trace/upload_environment.h"

#include <fmt/format.h>

namespace rt {
namespace {

/// Renders and writes what the options' outputs name.
void makePicture(const TraceOptions& options, const GpuScene& scene, const PictureSetup& setup,
                 StageTimer& stages) {
    const Picture picture = renderPicture(options, scene, setup, stages);
    const bool heat = options.heat != Heat::None; // its colours are what they are
    stages.begin("write");
    writePictures(options.outputPaths, imageOf(picture, options, scene, setup),
                  heat ? ToneMap::None : options.toneMap, heat ? 0.0 : options.exposureStops);
    stages.end();
    logPicture(picture, options);
    reportPicture(picture, options, scene, setup, stages);
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

void makeFrames(const TraceOptions& options, const std::vector<CameraKey>& path, const GpuScene& scene,
                PictureSetup& setup, StageTimer& stages) {
    for (unsigned frame = options.frames->first; frame <= options.frames->last; ++frame) {
        TraceOptions ofFrame = options;
        for (std::string& output : ofFrame.outputPaths) output = *framePath(output, frame);
        moveCamera(setup, cameraAt(path, frame, options.camera), options, scene.file.atlas);
        logInfo(fmt::format("frame {}", frame));
        makePicture(ofFrame, scene, setup, stages);
    }
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

} // namespace

void traceScene(const TraceOptions& given) {
    StageTimer stages;
    TraceOptions options = given;
    std::vector<CameraKey> path;
    const auto startPath = [&](std::vector<CameraKey> keys) {
        path = std::move(keys);
        checkPath(options, path);
        options.camera = cameraAt(path, options.frames->first, options.camera);
    };
    if (options.frames && !options.cameraPath.empty()) startPath(readCameraPath(options.cameraPath));
    PictureSetup setup;
    const auto choose = [&](const Atlas& atlas, const GlLimits&) -> SceneNeeds {
        if (options.frames && path.empty())
            startPath(pathOfCamera(options.camera.name, atlas.cameras, atlas.cameraKeys));
        setup = setUpPicture(options, atlas);
        return {renderFeatures(atlas, needsOf(options, setup)), static_cast<unsigned>(setup.lights.size())};
    };
    const GpuScene scene = loadScene(options, ShaderKind::Render, choose, stages);
    if (options.explain)
        writeFile("-", explanation(scene.file.atlas, scene.plan, options.environment.empty()));
    if (options.outputPaths.empty()) return;
    const std::optional<GpuEnvironment> environment = uploadEnvironment(options, setup, scene);
    if (options.frames)
        makeFrames(options, path, scene, setup, stages);
    else
        makePicture(options, scene, setup, stages);
    logStages(stages);
}

} // namespace rt
