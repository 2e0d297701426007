#pragma once
#include "formats/mesh.h"

#include <string>
#include <vector>

namespace rt {

class JsonNode;

/// A path as JSON: an array of {"frame": N, "eye": [x, y, z], "lookAt": [x, y, z], "up": [x, y, z],
/// "fov": degrees}, the last two of which may be left out, and are those of `usual` then. Comes back in the
/// order of the frames. Throws Error{InvalidContent} for anything else, an empty array or a frame that is
/// there twice.
std::vector<CameraKey> cameraPathOf(const JsonNode& json, const CameraKey& usual);

/// A number of degrees between 0 and 180. Throws Error{InvalidContent} for anything else.
double viewAngleOf(const JsonNode& json);

} // namespace rt
