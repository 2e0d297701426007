#pragma once
#include "common/bounds.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"

#include <optional>
#include <span>
#include <string>

namespace rt {

/// What the command line says of the camera.
struct CameraRequest {
    std::optional<glm::dvec3> eye = {};
    std::optional<glm::dvec3> lookAt = {};
    std::optional<glm::dvec3> up = {};
    std::optional<double> fovDegrees = {}; ///< of the picture's height
    std::optional<unsigned> view = {};     ///< kPerspectiveView, ...
    std::optional<double> height = {};     ///< orthographic: of what the picture shows, world units
    std::optional<double> lensRadius = {};
    std::optional<double> focusDistance = {};
    std::string name = {}; ///< of a camera of the scene; empty: none
    std::optional<glm::dvec3> towardsEye =
        {}; ///< direction from lookAt in which an eye stands that is not given
};

inline constexpr double kDefaultFovDegrees = 40.0;

/// A camera in world space.
struct CameraPose {
    glm::dvec3 eye{0.0};
    glm::dvec3 lookAt{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0}; ///< as given; see basisOf() for the camera's own
    double fovDegrees = kDefaultFovDegrees;
    unsigned view = kPerspectiveView;
    double height = 0.0;     ///< of what an orthographic picture shows
    double lensRadius = 0.0; ///< 0: everything is sharp
    double focusDistance = 0.0;
};

/// Unit axes: x to the right, y up, z forward; and half the picture's size, of perspective views at distance
/// 1.
struct CameraBasis {
    glm::dvec3 right, up, forward;
    double halfWidth, halfHeight;
};

/// Fills in from the camera of that name what the request leaves open. Throws Error{Usage}, with the names
/// that there are, if there is no such camera. A request without a name comes back as it is.
CameraRequest withNamedCamera(const CameraRequest& request, std::span<const NamedCamera> cameras);

/// A camera's name; safe for content that has not been checked.
std::string nameOf(const NamedCamera& camera);
/// "perspective", "orthographic", "panorama".
std::string viewName(unsigned view);

/// Throws Error{Usage} if a number is out of its range, or says nothing of a camera of this kind: --fov of
/// another than a perspective view, --focus without a lens.
void checkCamera(const CameraRequest& request);

/// Fills in what was not asked for: the look-at point is the scene's centre, the eye stands where all of the
/// box is in the picture, up is +y, or +z where the view is along y; a panorama is taken from the scene's
/// centre, towards -z; what is looked at is in focus. `aspect` = width / height. Throws Error{Usage} as
/// checkCamera() does, and if the eye is at the look-at point or up is parallel to the view.
CameraPose placeCamera(const CameraRequest& request, const BoundsD& scene, double aspect);

CameraBasis basisOf(const CameraPose& pose, double aspect);

/// Eye, axes, lens and focus in atlas space.
CameraParams cameraInAtlas(const CameraPose& pose, double aspect, const GridParams& grid);

/// Half the diagonal of the box, or a small positive length for a box of no size.
double sceneRadius(const BoundsD& scene);

} // namespace rt
