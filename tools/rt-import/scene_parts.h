#pragma once
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/read_scene.h"

#include <string>
#include <vector>

namespace rt {

/// All that is taken from one or several model files, so that the library's own copy of each can be freed
/// before the next one is read.
struct SceneParts {
    SceneSoup soup; ///< its materials are those below
    std::vector<Material> materials;
    std::uint64_t unusedMaterials = 0; ///< of the files
    LoadedImages images;
    std::vector<Light> lights;
    std::vector<NamedCamera> cameras; ///< names may be there twice
};

/// Adds a model's parts behind those of others. Throws
/// Error{LimitExceeded} for more than can be counted or kept, message prefixed by `name`.
void append(SceneParts&& part, SceneParts& whole, const std::string& name);

} // namespace rt
