#include "tools/rt-trace/checkpoint.h"

#include "common/error.h"
#include "formats/checkpoint_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

// What a picture is made with, part by part: bytes that are the same if the pictures are.
using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, const T& value) {
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}
template <class T>
void append(Bytes& bytes, const std::vector<T>& values) {
    const auto raw = std::as_bytes(std::span(values));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}
template <class... Values>
Bytes bytesOfAll(const Values&... values) {
    Bytes bytes;
    (append(bytes, values), ...);
    return bytes;
}

struct Made {
    const TraceOptions& options;
    const PictureSetup& setup;
    const SceneFeatures& features;
};
struct Setting {
    const char* name;
    Bytes (*of)(const Made&);
};
// In the order of CheckpointInfo::settings; another order is another version of the file.
constexpr Setting kSettings[] = {
    {"camera", [](const Made& m) { return bytesOfAll(m.setup.camera, m.features.view, m.features.hasLens); }},
    {"lights", [](const Made& m) { return bytesOfAll(m.setup.lights); }},
    {"environment",
     [](const Made& m) { return bytesOfAll(m.setup.environment.pixels, m.setup.params.environment); }},
    {"ambient light", [](const Made& m) { return bytesOfAll(m.setup.params.ambient); }},
    {"background", [](const Made& m) { return bytesOfAll(m.setup.params.background); }},
    {"filter", [](const Made& m) { return bytesOfAll(m.setup.params.filterSize, m.setup.params.samples.w); }},
    {"--max-depth", [](const Made& m) { return bytesOfAll(m.features.maxDepth); }},
    {"--precision or --intersect",
     [](const Made& m) { return bytesOfAll(m.features.doublePrecision, m.features.intersect); }},
    {"--target-error", [](const Made& m) { return bytesOfAll(m.options.targetError); }},
    {"channels",
     [](const Made& m) { return bytesOfAll(m.features.hasAovs, m.features.hasMoments, m.features.hasTime); }},
    {"kind of device", [](const Made& m) { return bytesOfAll(m.features.software); }},
    {"one sample per pixel, in its middle, or several, and the number of the first",
     [](const Made& m) { return bytesOfAll(m.features.multisample, m.options.range.first); }},
};
static_assert(std::size(kSettings) == kCheckpointSettings);

[[noreturn]] void throwForeign(const std::string& path, const std::string& what) {
    throw Error(ErrorKind::InvalidContent,
                fmt::format("{}: is the checkpoint of another picture: {}", path, what));
}

void requireEnough(const std::string& path, const Checkpoint& checkpoint, const PictureIdentity& identity) {
    std::uint32_t most = 0;
    for (const CheckpointTile& tile : checkpoint.tiles) most = std::max(most, tile.samples);
    if (most > identity.samples)
        throw Error(
            ErrorKind::Usage,
            fmt::format("--resume {}: its pixels have up to {} samples, more than the {} that are wanted; "
                        "say --spp {} or more, or begin anew without --resume",
                        path, most, identity.samples, most));
}

void requireSame(const std::string& path, const Checkpoint& checkpoint, const PictureIdentity& identity) {
    const CheckpointInfo& info = checkpoint.info;
    if (info.size[0] != identity.size.x || info.size[1] != identity.size.y)
        throwForeign(path, fmt::format("its size is {}x{}, not {}x{}", info.size[0], info.size[1],
                                       identity.size.x, identity.size.y));
    const auto& [x0, y0, x1, y1] = info.window;
    if (glm::uvec4(x0, y0, x1, y1) != identity.window)
        throwForeign(path, fmt::format("its part is {},{},{},{}; see --crop and --shard", x0, y0, x1, y1));
    if (info.atlasHash != identity.atlasHash)
        throwForeign(path, fmt::format("its atlas has the hash {:016x}, not {:016x}", info.atlasHash,
                                       identity.atlasHash));
    if (info.seed != identity.seed)
        throwForeign(path, fmt::format("its seed is {}, not {}", info.seed, identity.seed));
    requireEnough(path, checkpoint, identity); // first: one sample more than several is another setting too
    std::string different;
    for (std::size_t i = 0; i < kCheckpointSettings; ++i)
        if (info.settings[i] != identity.settings[i])
            different += fmt::format("{}{}", different.empty() ? "" : ", ", settingName(i));
    if (!different.empty())
        throwForeign(path, "these settings differ from what is asked for now: " + different);
}

} // namespace

const char* settingName(std::size_t index) {
    return kSettings[index].name;
}

PictureIdentity identityOf(const TraceOptions& options, const PictureSetup& setup,
                           const SceneFeatures& features, std::uint64_t atlasHash) {
    PictureIdentity identity{atlasHash, {}, options.size, options.window, options.seed, options.range.count};
    for (std::size_t i = 0; i < kCheckpointSettings; ++i)
        identity.settings[i] = hashOf(kSettings[i].of({options, setup, features}));
    return identity;
}

void saveCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                    const TileSamples& tiles, double gpuMs) {
    Checkpoint checkpoint;
    const glm::uvec4& window = identity.window;
    checkpoint.info = {identity.atlasHash,
                       {},
                       {identity.size.x, identity.size.y},
                       {window.x, window.y, window.z, window.w},
                       identity.samples,
                       identity.seed,
                       gpuMs};
    std::copy(identity.settings.begin(), identity.settings.end(), checkpoint.info.settings);
    for (const TileSamples::Tile& tile : tiles.tiles()) checkpoint.tiles.push_back({tile.samples, tile.goal});
    checkpoint.planes = film.save(window);
    writeCheckpoint(path, checkpoint);
}

double resumeCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                        TileSamples& tiles) {
    const Checkpoint checkpoint = readCheckpoint(path);
    requireSame(path, checkpoint, identity);
    const auto damaged = [&](const CheckpointTile& tile) {
        return tile.samples > tile.goal || tile.goal > checkpoint.info.samples;
    };
    if (checkpoint.tiles.size() != tiles.tiles().size() ||
        std::any_of(checkpoint.tiles.begin(), checkpoint.tiles.end(), damaged))
        throw Error(ErrorKind::InvalidContent, path + ": is damaged: its tiles are not those of the picture");
    if (!film.restore(identity.window, checkpoint.planes))
        throw Error(ErrorKind::InvalidContent,
                    path + ": is damaged: its pixels are not those of the picture");
    for (std::size_t i = 0; i < tiles.tiles().size(); ++i) {
        const CheckpointTile& saved = checkpoint.tiles[i];
        // Tiles whose error was small enough stay as they are; others get as many samples as are wanted now.
        const bool stopped = saved.goal < checkpoint.info.samples;
        tiles.tiles()[i] = {saved.samples, stopped ? saved.goal : identity.samples};
    }
    return checkpoint.info.gpuMs;
}

} // namespace rt
