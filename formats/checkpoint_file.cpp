#include "formats/checkpoint_file.h"

#include "formats/section_file.h"

#include <xxhash.h>

namespace rt {
namespace {

constexpr FileKind kCheckpointKind{{'\x89', 'R', 'T', 'C', 'H', 'K', 'P', '\n'}, 2, 0, "rt-trace checkpoint"};
constexpr std::uint32_t kInfo = sectionId("INFO");
constexpr std::uint32_t kTiles = sectionId("TILE");

std::uint32_t planeId(std::uint32_t image) {
    return sectionId("PLN0") + (image << 24); // the last character counts up
}

} // namespace

void writeCheckpoint(const std::string& path, const Checkpoint& checkpoint) {
    SectionFileWriter writer(kCheckpointKind);
    writer.add(kInfo, std::span<const CheckpointInfo>(&checkpoint.info, 1));
    writer.add(kTiles, std::span<const CheckpointTile>(checkpoint.tiles));
    for (const CheckpointPlane& plane : checkpoint.planes)
        writer.add(planeId(plane.image), std::span<const std::uint32_t>(plane.words));
    writer.write(path);
}

Checkpoint readCheckpoint(const std::string& path) {
    const SectionFile file(path, kCheckpointKind);
    file.verify([] {});
    Checkpoint checkpoint;
    checkpoint.info = file.get<CheckpointInfo>(kInfo, 1)[0];
    const auto tiles = file.get<CheckpointTile>(kTiles);
    checkpoint.tiles.assign(tiles.begin(), tiles.end());
    for (std::uint32_t image = 0; image < kCheckpointPlanes; ++image) {
        const auto words = file.get<std::uint32_t>(planeId(image));
        if (!words.empty()) checkpoint.planes.push_back({image, {words.begin(), words.end()}});
    }
    return checkpoint;
}

std::uint64_t hashOf(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

} // namespace rt
