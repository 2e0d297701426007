#pragma once
#include "formats/recipe.h"
#include "tools/rt-trace/shard_set.h"

#include <functional>

namespace rt {

/// That of the picture rendered in one run; not known of shards of samples, whose sum has other bits.
Recipe wholeRecipeOf(const std::vector<ShardFile>& files);

/// What the merged picture's header says; its channels have no values. `files`: as openShards() gives them.
Image mergedHeader(const std::vector<ShardFile>& files);

/// Hands the merged picture's rows to `take`, some after the other from its top; no more than a few rows of
/// few shards are in memory at a time. Throws Error{InvalidContent} for a shard that is damaged, at the
/// latest after its last row.
void mergeRows(const std::vector<ShardFile>& files, const std::function<void(const Image& rows)>& take);

} // namespace rt
