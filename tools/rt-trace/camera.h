#pragma once
#include "common/bounds.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"

#include <optional>

namespace rt {

/// What the command line says of the camera.
struct CameraRequest {
    std::optional<glm::dvec3> eye;
    std::optional<glm::dvec3> lookAt;
    std::optional<glm::dvec3> up;
    double fovDegrees = 40.0; ///< of the picture's height
};

/// A camera in world space.
struct CameraPose {
    glm::dvec3 eye{0.0};
    glm::dvec3 lookAt{0.0};
    glm::dvec3 up{0.0, 1.0, 0.0}; ///< as given; see basisOf() for the camera's own
    double fovDegrees = 40.0;
};

/// Unit axes: x to the right, y up, z forward; and half the picture's size at distance 1.
struct CameraBasis {
    glm::dvec3 right, up, forward;
    double halfWidth, halfHeight;
};

/// Fills in what was not asked for: the look-at point is the scene's centre, the eye stands where all of the
/// box is in the picture, up is +y, or +z where the view is along y. `aspect` = width / height. Throws
/// Error{Usage} if the eye is at the look-at point, up is parallel to the view, or fov is not inside (0,
/// 180).
CameraPose placeCamera(const CameraRequest& request, const BoundsD& scene, double aspect);

CameraBasis basisOf(const CameraPose& pose, double aspect);

/// Eye and axes in atlas space. Background, ambient and size are left 0.
CameraParams cameraInAtlas(const CameraPose& pose, double aspect, const GridParams& grid);

/// Half the diagonal of the box, or a small positive length for a box of no size.
double sceneRadius(const BoundsD& scene);

} // namespace rt
