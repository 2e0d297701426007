#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/import_report.h"

#include <string>
#include <vector>

namespace rt {

class StageTimer;

struct ImportedModel {
    Mesh mesh; ///< valid
    ImportReport report;
    std::vector<std::string> filesRead; ///< the model, its material libraries, buffers and textures
};

/// Models and scene files, and folders that scene files and models may read from besides their own.
struct SceneSources {
    std::vector<std::string> inputs;
    std::vector<std::string> roots;
};

/// Reads all of the inputs, in their order, into one mesh. Creases are edges at which generated normals do
/// not smooth, from `creaseDegrees` on. Throws Error{FileAccess, InvalidContent or LimitExceeded}.
ImportedModel importScene(const SceneSources& sources, double creaseDegrees, StageTimer& timer);

/// importScene() of one input.
ImportedModel importModel(const std::string& path, double creaseDegrees, StageTimer& timer);

} // namespace rt
