#include "tools/rt-trace/camera.h"

#include "common/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr double kMargin = 1.06;    // of the picture round the scene
constexpr double kLeastSine = 1e-6; // between the view and up
constexpr double kFlat = 0.02;      // extent over the largest one under which a scene counts as flat
const glm::dvec3 kTowardsEye(0.55, 0.45, 0.7);

// Flat scenes are looked at more from the front.
glm::dvec3 defaultDirection(const BoundsD& scene) {
    const glm::dvec3 extent = scene.extent();
    const double largest = std::max({extent.x, extent.y, extent.z});
    glm::dvec3 direction = kTowardsEye;
    for (int axis = 0; axis < 3; ++axis)
        if (extent[axis] < kFlat * largest) direction[axis] *= 3.0;
    return glm::normalize(direction);
}

glm::dvec3 defaultUp(const glm::dvec3& view) {
    const glm::dvec3 y(0.0, 1.0, 0.0);
    return glm::length(glm::cross(view, y)) < kLeastSine * glm::length(view) ? glm::dvec3(0.0, 0.0, 1.0) : y;
}

// Distance from the look-at point at which each corner of the box falls inside the picture.
double fittingDistance(const CameraPose& pose, const BoundsD& scene, double aspect) {
    const CameraBasis basis = basisOf(pose, aspect);
    double distance = 0.0;
    double nearest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? scene.hi.x : scene.lo.x, corner & 2 ? scene.hi.y : scene.lo.y,
                               corner & 4 ? scene.hi.z : scene.lo.z);
        const glm::dvec3 offset = point - pose.lookAt;
        const double depth = glm::dot(offset, basis.forward);
        const double x = std::abs(glm::dot(offset, basis.right)) / basis.halfWidth;
        const double y = std::abs(glm::dot(offset, basis.up)) / basis.halfHeight;
        distance = std::max(distance, kMargin * std::max(x, y) - depth);
        nearest = std::max(nearest, -depth);
    }
    return std::max(distance, nearest + 0.05 * sceneRadius(scene));
}

} // namespace

double sceneRadius(const BoundsD& scene) {
    const double radius = 0.5 * glm::length(scene.extent());
    return radius > 0.0 ? radius : std::max(1e-3 * glm::length(scene.centre()), 1e-3);
}

CameraPose placeCamera(const CameraRequest& request, const BoundsD& scene, double aspect) {
    if (!(request.fovDegrees > 0.0 && request.fovDegrees < 180.0))
        throw Error(ErrorKind::Usage,
                    fmt::format("--fov: {} is not between 0 and 180 degrees", request.fovDegrees));
    CameraPose pose;
    pose.fovDegrees = request.fovDegrees;
    pose.lookAt = request.lookAt.value_or(scene.centre());
    const glm::dvec3 towardsEye = request.eye ? *request.eye - pose.lookAt : defaultDirection(scene);
    if (!(glm::length(towardsEye) > 0.0))
        throw Error(ErrorKind::Usage, "--eye and --look-at are the same point");
    pose.up = request.up.value_or(defaultUp(towardsEye));
    const double sine = glm::length(glm::cross(glm::normalize(towardsEye), glm::normalize(pose.up)));
    if (!(sine >= kLeastSine)) throw Error(ErrorKind::Usage, "--up is 0 or parallel to the view");
    if (request.eye) {
        pose.eye = *request.eye;
    } else {
        // Any distance will do to measure by, but one that rounding does not swallow.
        pose.eye = pose.lookAt + towardsEye * std::max(sceneRadius(scene), glm::length(pose.lookAt));
        pose.eye = pose.lookAt + towardsEye * fittingDistance(pose, scene, aspect);
    }
    return pose;
}

CameraBasis basisOf(const CameraPose& pose, double aspect) {
    CameraBasis basis{};
    basis.forward = glm::normalize(pose.lookAt - pose.eye);
    basis.right = glm::normalize(glm::cross(basis.forward, pose.up));
    basis.up = glm::cross(basis.right, basis.forward);
    basis.halfHeight = std::tan(glm::radians(pose.fovDegrees) * 0.5);
    basis.halfWidth = basis.halfHeight * aspect;
    return basis;
}

CameraParams cameraInAtlas(const CameraPose& pose, double aspect, const GridParams& grid) {
    const CameraBasis basis = basisOf(pose, aspect);
    const glm::dvec3 eye = (pose.eye - glm::dvec3(grid.worldOffset)) * double(grid.worldOffset.w);
    CameraParams params{};
    params.eye = glm::vec4(glm::vec3(eye), 0.0f);
    params.right = glm::vec4(glm::vec3(basis.right * basis.halfWidth), 0.0f);
    params.up = glm::vec4(glm::vec3(basis.up * basis.halfHeight), 0.0f);
    params.forward = glm::vec4(glm::vec3(basis.forward), 0.0f);
    return params;
}

} // namespace rt
