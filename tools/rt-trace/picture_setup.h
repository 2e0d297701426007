#pragma once
#include "tools/rt-trace/environment.h"
#include "tools/rt-trace/options.h"
#include "tools/rt-trace/scene_features.h"

namespace rt {

/// Where a picture is taken from, and in which light.
struct PictureSetup {
    CameraPose pose;
    CameraParams camera{};
    RenderParams params{};
    std::vector<Light> lights;  ///< in atlas space
    EnvironmentMap environment; ///< no pixels: there is none
};

/// Safe for an atlas of which only the sizes are validated. Throws Error{Usage} as placeCamera() and
/// loadEnvironment() do.
PictureSetup setUpPicture(const TraceOptions& options, const Atlas& atlas);

/// The same picture from elsewhere; lights stay where they are.
void moveCamera(PictureSetup& setup, const CameraRequest& camera, const TraceOptions& options,
                const Atlas& atlas);

/// What the shader has to be able to do. The lights must outlive the result.
PictureNeeds needsOf(const TraceOptions& options, const PictureSetup& setup);

} // namespace rt
