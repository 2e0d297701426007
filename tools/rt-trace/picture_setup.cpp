#include "tools/rt-trace/picture_setup.h"

#include "common/error.h"
#include "common/log.h"
#include "tools/rt-trace/render.h"
#include "tools/rt-trace/turntable.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

const glm::vec3 kUsualBackground(0.32f, 0.4f, 0.5f);
const glm::vec3 kUsualAmbient(0.1f);

BoundsD sceneBounds(const AtlasInfo& info) {
    return {{info.worldLo[0], info.worldLo[1], info.worldLo[2]},
            {info.worldHi[0], info.worldHi[1], info.worldHi[2]}};
}

// That of the command line, else the atlas' own.
EnvironmentMap environmentOf(const TraceOptions& options, const Atlas& atlas) {
    if (!options.environment.empty()) return loadEnvironment(options.environment);
    if (atlas.environment.empty()) return {};
    const Surroundings& own = atlas.surroundings[0];
    return mapOf({own.width, own.height, {atlas.environment.begin(), atlas.environment.end()}, ""});
}

glm::vec3 backgroundOf(const TraceOptions& options, const Surroundings& own) {
    const glm::vec3 usual = own.hasBackground
                                ? glm::vec3(own.background[0], own.background[1], own.background[2])
                                : kUsualBackground;
    return options.background.value_or(usual);
}

RenderParams renderParams(const TraceOptions& options, const Atlas& atlas, bool hasEnvironment) {
    const Surroundings own = atlas.surroundings.empty() ? Surroundings{} : atlas.surroundings[0];
    // What the scene says of its own environment does not hold for another one.
    const bool isOwn = options.environment.empty();
    const double strength = options.environmentStrength.value_or(isOwn ? double(own.strength) : 1.0);
    const double turn = options.environmentTurn.value_or(isOwn ? double(own.turnDegrees) : 0.0);
    const glm::vec3 ambient = options.ambient.value_or(hasEnvironment ? glm::vec3(0.0f) : kUsualAmbient);
    RenderParams params = wholePicture(options.size);
    params.background = glm::vec4(backgroundOf(options, own), 0.0f);
    params.ambient =
        glm::vec4(ambient, static_cast<float>(options.occlusion * double(atlas.grid.worldOffset.w)));
    params.environment = glm::vec4(glm::vec3(static_cast<float>(strength)), static_cast<float>(turn / 360.0));
    params.filterSize.x = static_cast<float>(options.filterRadius);
    params.size = {options.size, options.window.x, options.window.y};
    params.region = options.window;
    params.samples = {options.range.first, options.range.count, options.seed, options.filter};
    return params;
}

void requireNoEnvironmentOptions(const TraceOptions& options) {
    if (!options.environmentTurn && !options.environmentStrength) return;
    throw Error(ErrorKind::Usage,
                fmt::format("{} needs --environment: the scene has none of its own",
                            options.environmentTurn ? "--environment-turn" : "--environment-strength"));
}

// Who placed cameras in a scene may expect to look through one of them.
void tellOfUnusedCameras(const TraceOptions& options, const Atlas& atlas) {
    constexpr std::size_t kMostNames = 5;
    if (atlas.cameras.empty() || options.camera.eye || !options.camera.name.empty() ||
        options.outputPaths.empty())
        return;
    std::string names;
    for (std::size_t i = 0; i < std::min(atlas.cameras.size(), kMostNames); ++i)
        names += (i == 0 ? "" : ", ") + nameOf(atlas.cameras[i]);
    if (atlas.cameras.size() > kMostNames)
        names += fmt::format(" and {} more", atlas.cameras.size() - kMostNames);
    logInfo(fmt::format("all of the scene is framed; --camera takes one of its cameras: {}", names));
}

} // namespace

PictureSetup setUpPicture(const TraceOptions& options, const Atlas& atlas) {
    PictureSetup setup;
    tellOfUnusedCameras(options, atlas);
    moveCamera(setup, options.camera, options, atlas);
    setup.environment = environmentOf(options, atlas);
    const bool hasEnvironment = !setup.environment.pixels.empty();
    if (!hasEnvironment) requireNoEnvironmentOptions(options);
    setup.params = renderParams(options, atlas, hasEnvironment);
    setup.lights = chooseLights(options.lights, atlas, sceneBounds(atlas.info), setup.pose, hasEnvironment);
    return setup;
}

void moveCamera(PictureSetup& setup, const CameraRequest& camera, const TraceOptions& options,
                const Atlas& atlas) {
    const double aspect = double(options.size.x) / options.size.y;
    const CameraRequest request = withNamedCamera(camera, atlas.cameras);
    setup.pose = options.turntable > 0 ? placeTurntable(request, sceneBounds(atlas.info), aspect)
                                       : placeCamera(request, sceneBounds(atlas.info), aspect);
    setup.camera = cameraInAtlas(setup.pose, aspect, atlas.grid);
}

PictureNeeds needsOf(const TraceOptions& options, const PictureSetup& setup) {
    PictureNeeds needs;
    needs.maxDepth = options.maxDepth;
    needs.lights = setup.lights;
    needs.environment = !setup.environment.pixels.empty();
    needs.occlusion = options.occlusion > 0.0;
    needs.view = setup.pose.view;
    needs.lens = setup.pose.lensRadius > 0.0;
    needs.multisample = options.samples > 1;
    needs.aovs = (options.aovs & kExtraAovs) != 0 || options.heat != Heat::None;
    needs.time = (options.aovs & kAovTime) != 0 || options.heat == Heat::Time;
    needs.multipass = options.kernel == Kernel::Multipass;
    needs.moments = (options.aovs & kAovVariance) != 0 || options.targetError > 0.0;
    return needs;
}

} // namespace rt
