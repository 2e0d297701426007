#include "tools/rt-trace/picture_options.h"

#include "common/error.h"
#include "tools/rt-trace/option_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace rt {
namespace {

constexpr std::array<const char*, 2> kKernelNames = {"compute", "multipass"}; // in the order of Kernel

[[noreturn]] void throwUsage(const std::string& message) {
    throw Error(ErrorKind::Usage, message);
}

void checkFrames(const TraceOptions& options) {
    const CameraRequest& camera = options.camera;
    const bool hasPath = !options.cameraPath.empty();
    if (options.turntable && (!options.frames || hasPath))
        throwUsage(options.frames ? "--turntable and --camera-path do not go together"
                                  : "--turntable needs --frames");
    if (hasPath && (!options.frames || !camera.name.empty()))
        throwUsage(options.frames ? "--camera and --camera-path do not go together: each is a path"
                                  : "--frames and --camera-path go together");
    if (!options.frames) return;
    if (options.turntable && camera.view == kPanoramaView)
        throwUsage("--turntable needs a view of something, not a panorama");
    if (!options.turntable && !hasPath && camera.name.empty())
        throwUsage(
            "--frames needs --turntable, --camera-path, or --camera and a scene in which that camera has a "
            "path");
    if (!options.turntable && (camera.eye || camera.lookAt || camera.up || camera.fovDegrees))
        throwUsage("--eye, --look-at, --up and --fov do not go with --frames: the camera's path says that");
    if (!options.checkpointPath.empty() || !options.resumePath.empty())
        throwUsage("--checkpoint and --resume are for single pictures; they do not go with --frames");
}

void checkKernel(const TraceOptions& options) {
    const bool timed = (options.aovs & kAovTime) != 0 || options.heat == Heat::Time;
    if (options.kernel == Kernel::Multipass && timed)
        throwUsage(
            "--kernel multipass does not go with --aov time or --heat time: its pixels take their time "
            "in many passes; use --heat steps");
}

// The place of the number is no name of a file where there are no frames.
void checkNames(const TraceOptions& options) {
    for (const std::string& path : options.outputPaths) {
        const bool numbered = framePath(path, 0).has_value();
        const bool several = options.frames && options.frames->first != options.frames->last;
        if (several && !numbered)
            throwUsage(fmt::format(
                "-o {}: with several --frames a name needs a %d or %04d where the number goes", path));
        if (!options.frames && numbered)
            throwUsage(fmt::format("-o {}: %d stands for the number of a frame; add --frames", path));
    }
}

// Whatever ends a picture elsewhere than at its last sample makes passes that cannot be compared.
void checkRepeat(const TraceOptions& options) {
    if (options.repeat > 0 &&
        (options.timeLimitSeconds > 0.0 || !options.checkpointPath.empty() || !options.resumePath.empty()))
        throwUsage("--repeat does not go with --time-limit, --checkpoint and --resume");
}

} // namespace

void addPictureOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    addCameraOptions(app, options, texts.camera);
    addLightOptions(app, options, texts.light);
    addSampleOptions(app, options, texts.samples);
    addOutputOptions(app, options, texts.output);
    app.add_option("--kernel", texts.kernel,
                   "How rays are traced: compute shaders, or three fragment shaders that are drawn over all "
                   "pixels in turn, as GPUs had to before; the same picture, later")
        ->check(oneOf(listOf(kKernelNames)))
        ->type_name(fmt::format("{}", fmt::join(kKernelNames, "|")))
        ->capture_default_str()
        ->group("Pictures: what traces them");
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
    options.kernel = static_cast<Kernel>(indexIn(kKernelNames, texts.kernel));
    checkKernel(options);
    convertShard(texts.shard, options);
    checkFrames(options);
    checkNames(options);
    checkRepeat(options);
    requireEffect(app, options);
}

} // namespace rt
