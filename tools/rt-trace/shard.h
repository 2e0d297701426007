#pragma once
#include "formats/shard_record.h"

#include <glm/vec4.hpp>

namespace rt {

/// Samples of each pixel, by their numbers.
struct SampleRange {
    unsigned first = 0, count = 1;
};

/// The part of a picture, or of each pixel's samples, that one of several runs renders.
struct Shard {
    unsigned index = 1; ///< 1 to count
    unsigned count = 1;
    ShardKind kind = ShardKind::Parts;
};

/// How many shards a picture of `window`, [xy, zw), and so many samples per pixel can be cut into.
unsigned mostShards(ShardKind kind, const glm::uvec4& window, unsigned samples);

/// The shard's part of the window: whole rows of the picture's tiles, about as many in each shard.
glm::uvec4 windowOf(const Shard& shard, const glm::uvec4& window);

/// The shard's part of each pixel's samples, about as many in each shard.
SampleRange samplesOf(const Shard& shard, unsigned samples);

} // namespace rt
