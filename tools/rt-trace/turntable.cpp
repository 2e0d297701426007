#include "tools/rt-trace/turntable.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>

namespace rt {
namespace {

constexpr int kViewsToFit = 64;

glm::dvec3 turnedEye(const CameraPose& pose, double degrees) {
    return glm::angleAxis(glm::radians(degrees), glm::normalize(pose.up)) * (pose.eye - pose.lookAt);
}

} // namespace

CameraPose placeTurntable(const CameraRequest& request, const BoundsD& scene, double aspect) {
    CameraPose first = placeCamera(request, scene, aspect);
    if (request.eye && (request.height || first.view != kOrthographicView)) return first; // nothing to fit
    double distance = glm::distance(first.eye, first.lookAt);
    double height = first.height;
    for (int view = 1; view < kViewsToFit; ++view) {
        CameraRequest turned = request;
        turned.towardsEye = glm::normalize(turnedEye(first, 360.0 * view / kViewsToFit));
        const CameraPose pose = placeCamera(turned, scene, aspect);
        distance = std::max(distance, glm::distance(pose.eye, pose.lookAt));
        height = std::max(height, pose.height);
    }
    if (!request.eye) first.eye = first.lookAt + glm::normalize(first.eye - first.lookAt) * distance;
    if (!request.focusDistance) first.focusDistance = glm::distance(first.eye, first.lookAt);
    first.height = height;
    return first;
}

CameraRequest turnedCamera(const CameraPose& pose, double degrees, const CameraRequest& request) {
    CameraRequest turned = request;
    turned.eye = pose.lookAt + turnedEye(pose, degrees);
    turned.lookAt = pose.lookAt;
    turned.up = pose.up;
    if (pose.view == kOrthographicView) turned.height = pose.height;
    return turned;
}

} // namespace rt
