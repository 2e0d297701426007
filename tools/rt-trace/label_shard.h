#pragma once
#include "formats/image.h"
#include "tools/rt-trace/checkpoint.h"
#include "tools/rt-trace/options.h"

namespace rt {

/// Says in the image's attributes which shard of which picture it is. The options name a shard.
void labelShard(Image& image, const TraceOptions& options, const PictureSetup& setup,
                const SceneFeatures& features, std::uint64_t atlasHash);

} // namespace rt
