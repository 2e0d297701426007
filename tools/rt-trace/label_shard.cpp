#include "tools/rt-trace/label_shard.h"

#include <span>

namespace rt {
namespace {

// What decides the pixels beside what decides the film's.
std::uint64_t hashOfHeat(const TraceOptions& options) {
    const double heat[] = {static_cast<double>(options.heat), options.heatMost};
    return hashOf(std::as_bytes(std::span(heat)));
}

} // namespace

void labelShard(Image& image, const TraceOptions& options, const PictureSetup& setup,
                const SceneFeatures& features, std::uint64_t atlasHash) {
    TraceOptions whole = options;
    whole.range = {0, options.samples};
    const PictureIdentity identity = identityOf(whole, setup, features, atlasHash);
    const Shard& shard = *options.shard;
    const glm::uvec4& window = options.wholeWindow;
    ShardRecord record{shard.index,     shard.count, shard.kind, {window.x, window.y, window.z, window.w},
                       options.samples, {},          0};
    for (std::size_t i = 0; i < kCheckpointSettings; ++i)
        record.settings.push_back({settingName(i), identity.settings[i]});
    record.settings.push_back({"--heat", hashOfHeat(options)});
    PixelHash hash(record);
    hash.add(image);
    record.pixelHash = hash.value();
    addShardRecord(image, record);
}

} // namespace rt
