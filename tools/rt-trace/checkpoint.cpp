#include "tools/rt-trace/checkpoint.h"

#include "common/error.h"
#include "formats/checkpoint_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
    const auto raw = std::as_bytes(values);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

[[noreturn]] void throwForeign(const std::string& path, const std::string& what) {
    throw Error(ErrorKind::InvalidContent,
                fmt::format("{}: is the checkpoint of another picture: {}", path, what));
}

void requireSame(const std::string& path, const CheckpointInfo& info, const PictureIdentity& identity) {
    if (info.size[0] != identity.size.x || info.size[1] != identity.size.y)
        throwForeign(path, fmt::format("its size is {}x{}, not {}x{}", info.size[0], info.size[1],
                                       identity.size.x, identity.size.y));
    const auto& [x0, y0, x1, y1] = info.window;
    if (glm::uvec4(x0, y0, x1, y1) != identity.window)
        throwForeign(path, fmt::format("its part is {},{},{},{}; see --crop", x0, y0, x1, y1));
    if (info.atlasHash != identity.atlasHash)
        throwForeign(path, fmt::format("its atlas has the hash {:016x}, not {:016x}", info.atlasHash,
                                       identity.atlasHash));
    if (info.seed != identity.seed)
        throwForeign(path, fmt::format("its seed is {}, not {}", info.seed, identity.seed));
    if (info.settingsHash != identity.settingsHash)
        throwForeign(path, "its view, light, filter, channels, --target-error or kind of device differ");
}

} // namespace

PictureIdentity identityOf(const TraceOptions& options, const PictureSetup& setup,
                           const SceneFeatures& features, std::uint64_t atlasHash) {
    RenderParams params = setup.params;
    params.samples.y = 0;
    std::vector<std::byte> bytes;
    append(bytes, std::span<const RenderParams>(&params, 1));
    append(bytes, std::span<const CameraParams>(&setup.camera, 1));
    append(bytes, std::span<const Light>(setup.lights));
    append(bytes, std::span<const glm::vec3>(setup.environment.pixels));
    append(bytes, std::span<const double>(&options.targetError, 1));
    const std::string defines = featureDefines(features);
    append(bytes, std::span<const char>(defines));
    return {atlasHash, hashOf(bytes), options.size, options.window, options.seed, options.samples};
}

void saveCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                    const TileSamples& tiles, double gpuMs) {
    Checkpoint checkpoint;
    const glm::uvec4& window = identity.window;
    checkpoint.info = {identity.atlasHash,
                       identity.settingsHash,
                       {identity.size.x, identity.size.y},
                       {window.x, window.y, window.z, window.w},
                       identity.samples,
                       identity.seed,
                       gpuMs};
    for (const TileSamples::Tile& tile : tiles.tiles()) checkpoint.tiles.push_back({tile.samples, tile.goal});
    checkpoint.planes = film.save(window);
    writeCheckpoint(path, checkpoint);
}

double resumeCheckpoint(const std::string& path, const PictureIdentity& identity, const Film& film,
                        TileSamples& tiles) {
    const Checkpoint checkpoint = readCheckpoint(path);
    requireSame(path, checkpoint.info, identity);
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
        tiles.tiles()[i] = {saved.samples, stopped ? saved.goal : std::max(identity.samples, saved.samples)};
    }
    return checkpoint.info.gpuMs;
}

} // namespace rt
