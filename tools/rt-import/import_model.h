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

/// Reads a model file into a mesh. Creases are edges at which generated normals do not smooth, from
/// `creaseDegrees` on. Throws Error{FileAccess, InvalidContent or LimitExceeded}.
ImportedModel importModel(const std::string& path, double creaseDegrees, StageTimer& timer);

} // namespace rt
