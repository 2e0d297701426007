#pragma once
#include "common/stage_timer.h"
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/choose_resolution.h"
#include "tools/rt-grid/limits.h"
#include "tools/rt-grid/nest_bricks.h"

#include <string>

namespace rt {

struct BuildOptions {
    std::uint32_t structure = kStructureCloud;
    ResolutionRequest resolution;
    NestOptions nest; ///< for kStructureNested
    MemoryLimit memory = defaultMemoryLimit();
    bool vdb = false; ///< memory for a VDB file counts too
};

/// Builds the atlas of a mesh; its stages appear in `timer`. `name` prefixes messages. The result depends on
/// the mesh and the options only. Throws Error{LimitExceeded}; see limits.h.
Atlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                 StageTimer& timer);

} // namespace rt
