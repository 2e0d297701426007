#pragma once
#include "formats/atlas_file.h"
#include "tools/rt-grid/atlas_figures.h"
#include "tools/rt-grid/atlas_sizes.h"
#include "tools/rt-grid/walk_rays.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rt {

/// What `rt-grid inspect` has to tell.
struct InspectReport {
    std::string path;
    const AtlasFile& file;
    AtlasFigures figures;
    RaySample rays;
    std::vector<DeviceLimits> devices; ///< guaranteedLimits(), and the device at hand if there is one
};

/// The table of sections, and how each fits each device.
std::string sectionTable(const std::vector<SectionSize>& sections, const std::vector<DeviceLimits>& devices);
nlohmann::json sectionsJson(const std::vector<SectionSize>& sections,
                            const std::vector<DeviceLimits>& devices);

/// For people.
std::string textOf(const InspectReport& report);

/// Everything, for --json.
nlohmann::json jsonOf(const InspectReport& report);

} // namespace rt
