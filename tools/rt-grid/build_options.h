#pragma once
#include "tools/rt-grid/choose_resolution.h"
#include "tools/rt-grid/limits.h"
#include "tools/rt-grid/quality.h"

#include <optional>

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

} // namespace rt
