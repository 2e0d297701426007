#pragma once
#include "tools/rt-import/scene_description.h"

#include <glm/mat4x4.hpp>

namespace rt {

class JsonNode;
class ModelFolder;

/// Which way is up in a file's coordinates.
enum class UpAxis { X, Y, Z };

/// "x", "y" or "z".
UpAxis readUpAxis(const JsonNode& json);
/// Metres: "m", "cm", "mm", "km", "in", "ft", or a number of them.
double readUnit(const JsonNode& json);
/// From coordinates in which `axis` is up to those in which +y is.
glm::dmat4 yUpFrom(UpAxis axis);

/// {"matrix": 16 numbers, column by column} or {"translate", "rotate", "scale"}: scaled first, then turned,
/// then moved. Throws Error{InvalidContent} for one that flattens.
glm::dmat4 readTransform(const JsonNode& json);
/// The same of an instance, which may have "materials" besides.
glm::dmat4 readInstance(const JsonNode& json);

/// A light or a camera in the scene file's coordinates.
Light readLight(const JsonNode& json);
DescribedCamera readCamera(const JsonNode& json, UpAxis upAxis);

/// {"file"} or {"color"}, and "strength" and "turn". Sets strength, turn and size.
EnvironmentPicture readEnvironment(const JsonNode& json, const ModelFolder& folder,
                                   Surroundings& surroundings);

} // namespace rt
