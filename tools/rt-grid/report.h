#pragma once
#include "common/stage_timer.h"
#include "formats/atlas.h"
#include "tools/rt-grid/choose_structure.h"
#include "tools/rt-grid/options.h"

#include <nlohmann/json_fwd.hpp>

namespace rt {

/// What a finished run has to tell.
struct GridReport {
    const GridOptions& options;
    const Atlas& atlas;
    const std::optional<StructureChoice>& choice;
    const StageTimer& timer;
};

/// Milliseconds of all stages but reading and writing files.
double buildMs(const StageTimer& timer);

/// One line for the log.
std::string summaryOf(const GridReport& report);

/// Everything, for --json.
nlohmann::json jsonOf(const GridReport& report);

} // namespace rt
