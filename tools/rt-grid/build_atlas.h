#pragma once
#include "common/stage_timer.h"
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/build_options.h"
#include "tools/rt-grid/choose_structure.h"

#include <optional>
#include <string>

namespace rt {

struct BuiltAtlas {
    Atlas atlas;
    std::optional<StructureChoice> choice; ///< where the structure was not given
};

/// Builds the atlas of a mesh; its stages appear in `timer`. `name` prefixes messages. The result depends on
/// the mesh and the options only. Throws Error{LimitExceeded}; see limits.h.
BuiltAtlas buildAtlas(const MeshFile& meshFile, const std::string& name, const BuildOptions& options,
                      StageTimer& timer);

} // namespace rt
