#pragma once
#include "common/stage_timer.h"
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/faults.h"

namespace rt {

/// One thing that was proved, or was not.
struct Proof {
    std::string name;
    std::string detail; ///< what was looked at
    Faults faults;
};

/// Proves what rays rely on, from the atlas' arrays alone and without any code that builds them: every
/// triangle is listed wherever a ray may look for it, and no leap passes over one that was not tested; see
/// README.md. With `source`, that the atlas holds that mesh, too. The atlas must have passed validate(). Its
/// proofs are stages of `timer`.
std::vector<Proof> verifyAtlas(const Atlas& atlas, const MeshFile* source, StageTimer& timer);

} // namespace rt
