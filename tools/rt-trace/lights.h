#pragma once
#include "common/bounds.h"
#include "formats/atlas.h"
#include "formats/gpu_interface.shared.h"
#include "formats/mesh.h"
#include "tools/rt-trace/camera.h"

#include <optional>
#include <vector>

namespace rt {

/// A light of the command line.
struct LightRequest {
    glm::dvec3 position{0.0}; ///< world
    /// Absent: enough for a white surface at the scene's centre that faces it, see lights.cpp.
    std::optional<glm::vec3> intensity = {};
    Light shape = pointLight({}, {}); ///< all but place and intensity, world
};

/// The lights of a picture in atlas space: those of the command line, else those of the atlas, of whatever
/// kind, else, unless an `environment` lights the scene, a key and a fill light by the camera. Lengths are
/// scaled, and intensities of points and spots so that intensity / distance^2 is the same in both spaces.
std::vector<Light> chooseLights(const std::vector<LightRequest>& requested, const Atlas& atlas,
                                const BoundsD& scene, const CameraPose& pose, bool environment = false);

} // namespace rt
