#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/import_report.h"
#include "tools/rt-import/repair_mesh.h"

#include <functional>
#include <string>
#include <vector>

namespace rt {

class StageTimer;

struct ImportSettings {
    RepairOptions repair = {};
    std::vector<std::string> allowedFormats = {};         ///< extensions read besides the usual ones
    bool strict = false;                                  ///< refuse what has to be mended or loses something
    std::function<void(double)> progress = [](double) {}; ///< is told which part is done, 0 to 1
};

struct ImportedModel {
    Mesh mesh; ///< valid
    ImportReport report;
    std::string
        filesAsked; ///< FilesAsked::text(): material libraries, buffers, textures, models of scene files
};

/// Models and scene files, and folders that scene files and models may read from besides their own.
struct SceneSources {
    std::vector<std::string> inputs;
    std::vector<std::string> roots;
};

/// "a.obj, b.glb".
std::string nameOf(const SceneSources& sources);
/// A warning behind that name, unless it begins with one of the inputs already.
std::string withName(const SceneSources& sources, const std::string& warning);

/// Reads all of the inputs, in their order, into one mesh. Throws Error{FileAccess, InvalidContent or
/// LimitExceeded}.
ImportedModel importScene(const SceneSources& sources, const ImportSettings& settings, StageTimer& timer);

/// importScene() of one input.
ImportedModel importModel(const std::string& path, const ImportSettings& settings, StageTimer& timer);

} // namespace rt
