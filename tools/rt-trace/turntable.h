#pragma once
#include "tools/rt-trace/camera.h"

namespace rt {

/// placeCamera(), from so far that the scene is in the picture whichever way round its look-at point the
/// camera goes; an eye that was asked for stays.
CameraPose placeTurntable(const CameraRequest& request, const BoundsD& scene, double aspect);

/// The request with a camera that has gone round `pose`'s look-at point about its up, to the right.
CameraRequest turnedCamera(const CameraPose& pose, double degrees, const CameraRequest& request);

} // namespace rt
