#include "tools/rt-trace/picture_setup.h"

#include "tools/rt-trace/render.h"

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
    params.size = {options.size, options.window.x, options.window.y};
    params.region = options.window;
    params.samples = {0, options.samples, options.seed, options.filter};
    return params;
}

} // namespace

PictureSetup setUpPicture(const TraceOptions& options, const Atlas& atlas) {
    PictureSetup setup;
    moveCamera(setup, options.camera, options, atlas);
    setup.params = renderParams(options, atlas.grid);
    setup.lights = chooseLights(options.lights, atlas, sceneBounds(atlas.info), setup.pose,
                                !options.environment.empty());
    if (!options.environment.empty()) setup.environment = loadEnvironment(options.environment);
    return setup;
}

void moveCamera(PictureSetup& setup, const CameraRequest& camera, const TraceOptions& options,
                const Atlas& atlas) {
    const double aspect = double(options.size.x) / options.size.y;
    setup.pose = placeCamera(withNamedCamera(camera, atlas.cameras), sceneBounds(atlas.info), aspect);
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
    needs.moments = (options.aovs & kAovVariance) != 0 || options.targetError > 0.0;
    return needs;
}

} // namespace rt
