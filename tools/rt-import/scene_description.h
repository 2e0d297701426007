#pragma once
#include "formats/environment_picture.h"
#include "formats/mesh.h"
#include "tools/rt-import/material_override.h"

#include <glm/mat4x4.hpp>

#include <string>
#include <vector>

namespace rt {

class FilesAsked;

/// A model file and where it stands.
struct PlacedModel {
    std::string path;
    std::vector<std::string> folders;     ///< where its other files may lie besides its own folder
    std::vector<glm::dmat4> placements;   ///< world from model
    std::vector<std::uint32_t> overrides; ///< indices, in the order in which they count
    bool lights = true;
    bool cameras = true;
};

/// A camera of a scene file and, if it moves, its path.
struct DescribedCamera {
    NamedCamera camera;
    std::vector<CameraKey> path;
};

/// What scene files and the command line say of a scene, its models not yet read.
struct SceneDescription {
    std::vector<PlacedModel> models;
    std::vector<MaterialOverride> overrides;
    std::vector<Light> lights;
    std::vector<DescribedCamera> cameras; ///< names may be there twice
    Surroundings surroundings;
    EnvironmentPicture environment;
    bool hasEnvironment = false;
    bool hasSceneFile = false;
    std::vector<std::string> warnings;
};

/// Whether a file of this name describes a scene: *.scene.json.
bool isSceneFile(const std::string& path);

/// Puts the inputs together, models and scene files, in their order. World space is that of the first scene
/// file, turned so that +y is up; other scene files, and models whose unit is known, are scaled to its unit.
/// Files that a scene file names may lie in its own folder, below, or in `roots`. Throws Error{FileAccess},
/// Error{InvalidContent} with file and JSON pointer, or Error{LimitExceeded}. Models are not opened.
/// `asked` is told every file that is looked for.
SceneDescription describeScene(const std::vector<std::string>& inputs, const std::vector<std::string>& roots,
                               FilesAsked* asked = nullptr);

} // namespace rt
