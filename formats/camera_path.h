#pragma once
#include "formats/mesh.h"

#include <string>
#include <vector>

namespace rt {

class JsonNode;

/// A path as JSON: an array of {"frame": N, "eye": [x, y, z], "lookAt": [x, y, z], "up": [x, y, z],
/// "fov": degrees}, the last two of which may be left out, and are those of `usual` then. Frames are whole
/// numbers from 0 to 999999, each larger than the one before. Throws Error{InvalidContent} for anything
/// else and for an empty array.
std::vector<CameraKey> cameraPathOf(const JsonNode& json, const CameraKey& usual);

/// A number of degrees between 0 and 180. Throws Error{InvalidContent} for anything else.
double viewAngleOf(const JsonNode& json);

} // namespace rt
