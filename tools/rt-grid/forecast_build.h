#pragma once
#include "common/stage_timer.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/atlas_sizes.h"
#include "tools/rt-grid/build_options.h"
#include "tools/rt-grid/choose_structure.h"

namespace rt {

/// What a build will take.
struct BuildForecast {
    std::uint32_t structure = 0;
    AtlasSizes sizes;
    std::uint64_t occupiedVoxels = 0; ///< bricks' included
    std::uint64_t references = 0;
    std::uint64_t bricks = 0;
    std::uint64_t peakBytes = 0;           ///< of memory, without the program itself and the mapped mesh
    std::optional<StructureChoice> choice; ///< where the structure was not given
    std::string refusal; ///< why the build would end with exit code 5; empty if it would not
};

/// Forecasts buildAtlas() without building: flat grids exactly, by counting; bricks from a sample of the
/// grid's voxels. Throws Error{LimitExceeded} where a build would before it looks at triangles.
BuildForecast forecastBuild(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                            StageTimer& timer);

} // namespace rt
