#include "tools/rt-trace/picture_options.h"

#include "common/error.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

[[noreturn]] void throwUsage(const std::string& message) {
    throw Error(ErrorKind::Usage, message);
}

void checkFrames(const TraceOptions& options) {
    const CameraRequest& camera = options.camera;
    const bool hasPath = !options.cameraPath.empty();
    if (hasPath && (!options.frames || !camera.name.empty()))
        throwUsage(options.frames ? "--camera and --camera-path do not go together: each is a path"
                                  : "--frames and --camera-path go together");
    if (!options.frames) return;
    if (!hasPath && camera.name.empty())
        throwUsage("--frames needs --camera-path, or --camera and a scene in which that camera has a path");
    if (camera.eye || camera.lookAt || camera.up || camera.fovDegrees)
        throwUsage("--eye, --look-at, --up and --fov do not go with --frames: the camera's path says that");
    if (!options.checkpointPath.empty() || !options.resumePath.empty())
        throwUsage("--checkpoint and --resume are for single pictures; they do not go with --frames");
}

// The place of the number is no name of a file where there are no frames.
void checkNames(const TraceOptions& options) {
    for (const std::string& path : options.outputPaths) {
        const bool numbered = framePath(path, 0).has_value();
        if (options.frames && !numbered)
            throwUsage(
                fmt::format("-o {}: with --frames a name needs a %d or %04d where the number goes", path));
        if (!options.frames && numbered)
            throwUsage(fmt::format("-o {}: %d stands for the number of a frame; add --frames", path));
    }
}

} // namespace

void addPictureOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    addCameraOptions(app, options, texts.camera);
    addLightOptions(app, options, texts.light);
    addSampleOptions(app, options, texts.samples);
    addOutputOptions(app, options, texts.output);
    addShardOptions(app, texts.shard);
}

void convertPictureTexts(const CLI::App& app, const PictureTexts& texts, TraceOptions& options) {
    for (const double number :
         {options.environmentTurn.value_or(0.0), options.environmentStrength.value_or(1.0),
          options.exposureStops, options.occlusion, options.timeLimitSeconds, options.targetError})
        if (!std::isfinite(number)) throwUsage("'nan' and 'inf' are no numbers for an option");
    convertCamera(texts.camera, options);
    convertLight(texts.light, options);
    convertSamples(texts.samples, options);
    convertOutput(texts.output, options);
    convertShard(texts.shard, options);
    checkFrames(options);
    checkNames(options);
    requireEffect(app, options);
}

} // namespace rt
