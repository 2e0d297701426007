#pragma once
#include "formats/mesh.h"
#include "tools/rt-grid/forecast_build.h"
#include "tools/rt-grid/options.h"

#include <nlohmann/json_fwd.hpp>

namespace rt {

/// What --dry-run has to tell.
struct ForecastReport {
    const GridOptions& options;
    BuildForecast forecast;
    std::uint64_t programBytes; ///< of memory, before the mesh is read
    std::uint64_t meshBytes;    ///< of the mapped file
    std::vector<DeviceLimits> devices;

    std::uint64_t memoryBytes() const { return programBytes + meshBytes + forecast.peakBytes; }
};

/// Of all arrays of a mesh: about what its file has.
std::uint64_t fileBytesOf(const Mesh& mesh);

/// For people.
std::string textOf(const ForecastReport& report);

/// Everything, for --json.
nlohmann::json jsonOf(const ForecastReport& report);

} // namespace rt
