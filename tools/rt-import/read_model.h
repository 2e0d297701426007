#pragma once
#include "tools/rt-import/scene_description.h"
#include "tools/rt-import/scene_parts.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rt {

class ModelFolder;
class StageTimer;
struct ImportReport;
struct ImportSettings;

/// The overrides of a scene, and which of them changed something.
struct Overrides {
    const std::vector<MaterialOverride>& all;
    std::vector<bool> matched;

    /// Those of the given numbers, in their order.
    void apply(const std::vector<std::uint32_t>& indices, MaterialSource& material);
};

/// Reads one model file: its triangles at all of its places, the materials that they use with the model's
/// overrides, their images, its lights and cameras. What is mended, left out or lost goes into `report` and
/// `warnings`. Throws Error{FileAccess, InvalidContent or LimitExceeded}.
SceneParts readModel(const PlacedModel& model, const ImportSettings& settings, Overrides& overrides,
                     const ModelFolder& folder, ImportReport& report, std::vector<std::string>& warnings,
                     StageTimer& timer);

} // namespace rt
