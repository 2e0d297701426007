#pragma once
#include "formats/image.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What shards of a picture have of it.
enum class ShardKind {
    Parts,   ///< some of its rows, with all samples
    Samples, ///< all of its pixels, with some samples of each
};
/// As files and options call them, by their numbers.
inline constexpr std::array<const char*, 2> kShardKindNames = {"parts", "samples"};

/// What the EXR of a shard says beside what the picture's own says: as attributes named rt:shard..., which
/// the merged picture does not have.
struct ShardRecord {
    unsigned index = 1; ///< 1 to count
    unsigned count = 1;
    ShardKind kind = ShardKind::Parts;
    std::array<std::uint32_t, 4> window{}; ///< x0, y0, x1, y1: all that the shards make together
    std::uint32_t samples = 1;             ///< per pixel, of all shards together
    struct Setting {
        std::string name;
        std::uint64_t hash = 0;
        bool operator==(const Setting&) const = default;
    };
    std::vector<Setting> settings; ///< all else that decides what the pixels become; names have no ; or =
    std::uint64_t pixelHash = 0;   ///< see PixelHash
};

/// Hash of a shard's pixels and of its record (but for pixelHash), so that one that was damaged or changed
/// since is known. Does not depend on how the rows are handed over.
class PixelHash {
public:
    explicit PixelHash(const ShardRecord& record);
    PixelHash(PixelHash&&) noexcept;
    ~PixelHash();
    /// The next rows.
    void add(const Image& rows);
    std::uint64_t value() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Sets the attributes. record.pixelHash must be that of the image.
void addShardRecord(Image& image, const ShardRecord& record);

/// Takes the attributes away again. Nothing if the image has none; throws Error{InvalidContent} prefixed by
/// `name` if they are damaged.
std::optional<ShardRecord> takeShardRecord(Image& image, const std::string& name);

} // namespace rt
