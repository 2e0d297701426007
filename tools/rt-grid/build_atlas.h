#pragma once
#include "common/stage_timer.h"
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/choose_resolution.h"
#include "tools/rt-grid/choose_structure.h"
#include "tools/rt-grid/limits.h"
#include "tools/rt-grid/quality.h"

#include <optional>
#include <string>

namespace rt {

struct BuildOptions {
    std::optional<std::uint32_t> structure; ///< nothing: as the scene's statistics favour
    Quality quality = Quality::balanced;
    ResolutionRequest resolution;
    std::optional<NestOptions> nest; ///< instead of the quality's
    MemoryLimit memory = defaultMemoryLimit();
    bool vdb = false;      ///< memory for a VDB file counts too
    double padScale = 1.0; ///< see GridLayout; for tests of what the pad is needed for
};

struct BuiltAtlas {
    Atlas atlas;
    std::optional<StructureChoice> choice; ///< where the structure was not given
};

/// Builds the atlas of a mesh; its stages appear in `timer`. `name` prefixes messages. The result depends on
/// the mesh and the options only. Throws Error{LimitExceeded}; see limits.h.
BuiltAtlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                      StageTimer& timer);

} // namespace rt
