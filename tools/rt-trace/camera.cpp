#include "tools/rt-trace/camera.h"

#include "common/error.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace rt {
namespace {

static_assert(kCameraPerspective == kPerspectiveView && kCameraOrthographic == kOrthographicView &&
              kCameraPanorama == kPanoramaView);

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

glm::dvec3 cornerOf(const BoundsD& box, int corner) {
    return {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
            corner & 4 ? box.hi.z : box.lo.z};
}

// Distance from the look-at point at which each corner of the box falls inside the picture, or, orthographic,
// lies before the eye.
double fittingDistance(const CameraPose& pose, const BoundsD& scene, double aspect) {
    const CameraBasis basis = basisOf(pose, aspect);
    double distance = 0.0;
    double nearest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 offset = cornerOf(scene, corner) - pose.lookAt;
        const double depth = glm::dot(offset, basis.forward);
        const double x = std::abs(glm::dot(offset, basis.right)) / basis.halfWidth;
        const double y = std::abs(glm::dot(offset, basis.up)) / basis.halfHeight;
        if (pose.view == kPerspectiveView) distance = std::max(distance, kMargin * std::max(x, y) - depth);
        nearest = std::max(nearest, -depth);
    }
    return std::max(distance, nearest + 0.05 * sceneRadius(scene));
}

// Height at which an orthographic picture holds the box.
double fittingHeight(const CameraPose& pose, const BoundsD& scene, double aspect) {
    const CameraBasis basis = basisOf(pose, aspect);
    double half = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 offset = cornerOf(scene, corner) - pose.lookAt;
        half = std::max(
            {half, std::abs(glm::dot(offset, basis.right)) / aspect, std::abs(glm::dot(offset, basis.up))});
    }
    return 2.0 * kMargin * (half > 0.0 ? half : sceneRadius(scene));
}

void requirePositive(const std::optional<double>& value, bool mayBeZero, const char* option) {
    if (value && !(*value > 0.0 || (mayBeZero && *value == 0.0)))
        throw Error(ErrorKind::Usage, fmt::format("{}: {} is not positive", option, *value));
}

// All but the place of the eye, and what depends on it.
CameraPose poseOf(const CameraRequest& request, const BoundsD& scene) {
    CameraPose pose;
    pose.fovDegrees = request.fovDegrees.value_or(kDefaultFovDegrees);
    pose.view = request.view.value_or(kPerspectiveView);
    pose.lensRadius = request.lensRadius.value_or(0.0);
    const bool panorama = pose.view == kPanoramaView;
    pose.lookAt = scene.centre();
    if (panorama) pose.lookAt = request.eye.value_or(pose.lookAt) - glm::dvec3(0.0, 0.0, 1.0);
    if (request.lookAt) pose.lookAt = *request.lookAt;
    return pose;
}

std::optional<glm::dvec3> requestedEye(const CameraRequest& request, const BoundsD& scene) {
    const bool panorama = request.view == kPanoramaView;
    if (!request.eye && panorama) return scene.centre();
    return request.eye;
}

glm::dvec3 toPoint(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

} // namespace

double sceneRadius(const BoundsD& scene) {
    const double radius = 0.5 * glm::length(scene.extent());
    return radius > 0.0 ? radius : std::max(1e-3 * glm::length(scene.centre()), 1e-3);
}

std::string nameOf(const NamedCamera& camera) {
    return {camera.name, strnlen(camera.name, sizeof camera.name)};
}

std::string viewName(unsigned view) {
    constexpr std::array<const char*, 3> kNames = {"perspective", "orthographic", "panorama"};
    return view < kNames.size() ? kNames[view] : "unknown";
}

CameraRequest withNamedCamera(const CameraRequest& request, std::span<const NamedCamera> cameras) {
    if (request.name.empty()) return request;
    const auto named = std::find_if(cameras.begin(), cameras.end(), [&](const NamedCamera& camera) {
        return nameOf(camera) == request.name;
    });
    if (named == cameras.end()) {
        std::string names;
        for (const NamedCamera& camera : cameras) names += (names.empty() ? "" : ", ") + nameOf(camera);
        throw Error(ErrorKind::Usage, fmt::format("--camera: the scene has no '{}'; {}", request.name,
                                                  names.empty() ? "it has no cameras" : "it has " + names));
    }
    CameraRequest filled = request;
    if (!filled.eye) filled.eye = toPoint(named->eye);
    if (!filled.lookAt) filled.lookAt = toPoint(named->lookAt);
    if (!filled.up) filled.up = toPoint(named->up);
    if (!filled.view) filled.view = named->kind;
    if (filled.view != named->kind) return filled; // the rest says nothing of another kind
    if (named->kind == kCameraPanorama) return filled;
    if (named->kind == kCameraOrthographic) {
        if (!filled.height) filled.height = named->height;
        return filled;
    }
    if (!filled.fovDegrees) filled.fovDegrees = named->fovDegrees;
    if (!filled.lensRadius) filled.lensRadius = named->lensRadius;
    if (!filled.focusDistance && *filled.lensRadius > 0.0 && named->lensRadius > 0.0)
        filled.focusDistance = named->focusDistance;
    return filled;
}

void checkCamera(const CameraRequest& request) {
    const double fov = request.fovDegrees.value_or(kDefaultFovDegrees);
    if (!(fov > 0.0 && fov < 180.0))
        throw Error(ErrorKind::Usage, fmt::format("--fov: {} is not between 0 and 180 degrees", fov));
    requirePositive(request.height, false, "--height");
    requirePositive(request.lensRadius, true, "--lens-radius");
    requirePositive(request.focusDistance, false, "--focus");
    const unsigned view = request.view.value_or(kPerspectiveView);
    const bool lens = request.lensRadius.value_or(0.0) > 0.0;
    struct Rule {
        bool broken;
        const char* message;
    };
    for (const Rule& rule :
         {Rule{lens && view != kPerspectiveView, "--lens-radius: only perspective pictures have a lens"},
          Rule{request.fovDegrees && view != kPerspectiveView, "--fov: only perspective pictures have one"},
          Rule{request.height && view != kOrthographicView, "--height needs --projection orthographic"},
          Rule{request.focusDistance && !lens, "--focus needs --lens-radius: all is sharp without a lens"}})
        if (rule.broken) throw Error(ErrorKind::Usage, rule.message);
}

CameraPose placeCamera(const CameraRequest& request, const BoundsD& scene, double aspect) {
    checkCamera(request);
    CameraPose pose = poseOf(request, scene);
    const std::optional<glm::dvec3> eye = requestedEye(request, scene);
    const glm::dvec3 towardsEye =
        eye ? *eye - pose.lookAt : request.towardsEye.value_or(defaultDirection(scene));
    if (!(glm::length(towardsEye) > 0.0))
        throw Error(ErrorKind::Usage, "--eye and --look-at are the same point");
    pose.up = request.up.value_or(defaultUp(towardsEye));
    const double sine = glm::length(glm::cross(glm::normalize(towardsEye), glm::normalize(pose.up)));
    if (!(sine >= kLeastSine)) throw Error(ErrorKind::Usage, "--up is 0 or parallel to the view");
    // Any distance will do to measure by, but one that rounding does not swallow.
    pose.eye =
        eye.value_or(pose.lookAt + towardsEye * std::max(sceneRadius(scene), glm::length(pose.lookAt)));
    if (pose.view == kOrthographicView)
        pose.height = request.height ? *request.height : fittingHeight(pose, scene, aspect);
    if (!eye) pose.eye = pose.lookAt + towardsEye * fittingDistance(pose, scene, aspect);
    pose.focusDistance = request.focusDistance.value_or(glm::distance(pose.eye, pose.lookAt));
    return pose;
}

CameraBasis basisOf(const CameraPose& pose, double aspect) {
    CameraBasis basis{};
    basis.forward = glm::normalize(pose.lookAt - pose.eye);
    basis.right = glm::normalize(glm::cross(basis.forward, pose.up));
    basis.up = glm::cross(basis.right, basis.forward);
    basis.halfHeight =
        pose.view == kOrthographicView ? 0.5 * pose.height : std::tan(glm::radians(pose.fovDegrees) * 0.5);
    basis.halfWidth = basis.halfHeight * aspect;
    return basis;
}

CameraParams cameraInAtlas(const CameraPose& pose, double aspect, const GridParams& grid) {
    const CameraBasis basis = basisOf(pose, aspect);
    const double scale = grid.worldOffset.w;
    const double axes = pose.view == kOrthographicView ? scale : 1.0; // there they are lengths
    const glm::dvec3 eye = (pose.eye - glm::dvec3(grid.worldOffset)) * scale;
    CameraParams params{};
    params.eye = glm::vec4(glm::vec3(eye), static_cast<float>(pose.lensRadius * scale));
    params.right = glm::vec4(glm::vec3(basis.right * (basis.halfWidth * axes)), 0.0f);
    params.up = glm::vec4(glm::vec3(basis.up * (basis.halfHeight * axes)), 0.0f);
    params.forward = glm::vec4(glm::vec3(basis.forward), static_cast<float>(pose.focusDistance * scale));
    return params;
}

} // namespace rt
