#pragma once
#include "formats/camera_path.h"
#include "tools/rt-trace/camera.h"

#include <span>
#include <string>
#include <vector>

namespace rt {

/// cameraPathOf() of a file; --fov's usual angle where it says none. Throws Error{FileAccess} too.
std::vector<CameraKey> readCameraPath(const std::string& path);

/// The path of the scene's camera of that name. Throws Error{Usage} if it has none. Safe for keys that have
/// not been checked.
std::vector<CameraKey> pathOfCamera(const std::string& name, std::span<const NamedCamera> cameras,
                                    std::span<const CameraKey> keys);

/// The request with the camera of a frame: on a straight line between the frames before and behind it; before
/// the first and behind the last frame it stands still.
CameraRequest cameraAt(std::span<const CameraKey> keys, double frame, const CameraRequest& request);

} // namespace rt
