#include "tools/rt-trace/shard.h"

#include "tools/rt-trace/tile_samples.h"

#include <algorithm>

namespace rt {
namespace {

// Where the shard's share of so many things begins; that of the shard after it is where it ends.
unsigned beginOf(unsigned index, unsigned count, unsigned things) {
    return static_cast<unsigned>(std::uint64_t(things) * (index - 1) / count);
}

// [x, y) of the rows of tiles that the window touches.
struct TileRows {
    unsigned first, end;
};
TileRows tileRowsOf(const glm::uvec4& window) {
    constexpr unsigned kSide = TileSamples::kSide;
    return {window.y / kSide, (window.w + kSide - 1) / kSide};
}

} // namespace

unsigned mostShards(ShardKind kind, const glm::uvec4& window, unsigned samples) {
    const TileRows rows = tileRowsOf(window);
    return kind == ShardKind::Parts ? rows.end - rows.first : samples;
}

glm::uvec4 windowOf(const Shard& shard, const glm::uvec4& window) {
    if (shard.kind == ShardKind::Samples) return window;
    const TileRows rows = tileRowsOf(window);
    const auto border = [&](unsigned index) {
        const unsigned row = rows.first + beginOf(index, shard.count, rows.end - rows.first);
        return std::clamp(row * TileSamples::kSide, window.y, window.w);
    };
    return {window.x, border(shard.index), window.z, border(shard.index + 1)};
}

SampleRange samplesOf(const Shard& shard, unsigned samples) {
    if (shard.kind == ShardKind::Parts) return {0, samples};
    const unsigned first = beginOf(shard.index, shard.count, samples);
    return {first, beginOf(shard.index + 1, shard.count, samples) - first};
}

} // namespace rt
