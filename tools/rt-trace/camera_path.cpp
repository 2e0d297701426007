#include "tools/rt-trace/camera_path.h"

#include "common/error.h"
#include "common/json_reader.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>

namespace rt {

std::vector<CameraKey> readCameraPath(const std::string& path) {
    CameraKey usual;
    usual.fovDegrees = kDefaultFovDegrees;
    return cameraPathOf(JsonNode::read(path), usual);
}

std::vector<CameraKey> pathOfCamera(const std::string& name, std::span<const NamedCamera> cameras,
                                    std::span<const CameraKey> keys) {
    std::vector<CameraKey> path;
    std::copy_if(keys.begin(), keys.end(), std::back_inserter(path), [&](const CameraKey& key) {
        return key.camera < cameras.size() && nameOf(cameras[key.camera]) == name;
    });
    if (path.empty())
        throw Error(
            ErrorKind::Usage,
            fmt::format("--frames: the scene has no path of a camera '{}'; give --camera-path", name));
    return path;
}

CameraRequest cameraAt(std::span<const CameraKey> keys, double frame, const CameraRequest& request) {
    const auto behind =
        std::find_if(keys.begin(), keys.end(), [=](const CameraKey& key) { return key.frame >= frame; });
    const CameraKey& b = behind == keys.end() ? keys.back() : *behind;
    const CameraKey& a = behind == keys.begin() ? b : *(behind - 1);
    const double part =
        b.frame > a.frame ? std::clamp((frame - a.frame) / (b.frame - a.frame), 0.0, 1.0) : 0.0;
    CameraRequest at = request;
    at.eye = glm::mix(a.eye, b.eye, part);
    at.lookAt = glm::mix(a.lookAt, b.lookAt, part);
    at.up = glm::mix(a.up, b.up, part);
    if (request.view.value_or(kPerspectiveView) == kPerspectiveView)
        at.fovDegrees = glm::mix(a.fovDegrees, b.fovDegrees, part);
    return at;
}

} // namespace rt
