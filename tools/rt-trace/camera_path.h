#pragma once
#include "tools/rt-trace/camera.h"

#include <span>
#include <string>
#include <vector>

namespace rt {

/// A camera at one frame of a path.
struct CameraKey {
    double frame = 0.0;
    glm::dvec3 eye{0.0};
    glm::dvec3 lookAt{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0};
    double fovDegrees = kDefaultFovDegrees;
};

/// A JSON array of {"frame": N, "eye": [x, y, z], "lookAt": [x, y, z], "up": [x, y, z], "fov": degrees}; up
/// and fov may be absent. Comes back in the order of the frames. Throws Error{FileAccess}, or
/// Error{InvalidContent} for anything else, an empty array or a frame that is there twice.
std::vector<CameraKey> readCameraPath(const std::string& path);

/// The request with the camera of a frame: on a straight line between the frames before and behind it; before
/// the first and behind the last frame it stands still.
CameraRequest cameraAt(std::span<const CameraKey> keys, double frame, const CameraRequest& request);

} // namespace rt
