#pragma once
#include "formats/picture.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What of a part's header decides whether and how its pixels are read, as the file says it: not checked.
struct ExrPartHeader {
    struct Channel {
        std::string name;
        std::optional<ImageChannel::Type> type; ///< absent: one that is not known
        int xSampling = 1, ySampling = 1;       ///< pixels that have one value together
        bool isFull() const { return xSampling == 1 && ySampling == 1; }
    };
    struct Tiles {
        std::uint32_t width = 0, height = 0;
        bool hasKnownModes = false;
    };
    std::string type;                                    ///< "scanlineimage", ...; empty: not given
    std::size_t compression = 0;                         ///< its number: NONE is 0
    std::int32_t minX = 0, minY = 0, maxX = 0, maxY = 0; ///< data window, of which max is the last pixel
    std::vector<Channel> channels;
    bool isTiled = false;
    std::optional<Tiles> tiles;
    std::optional<std::int64_t> chunkCount;
};

/// What a reader accepts.
struct ExrRules {
    PictureLimits limits;
    bool isPlain = false; ///< one part, whose channels all have the full size
};

struct ExrLayout {
    std::uint64_t width = 0, height = 0;
    std::uint64_t values = 0; ///< pixels times channels
};

/// Refuses what is not supported, and sizes that a file of `fileBytes` cannot hold, before anything is
/// allocated. Throws Error{InvalidContent} or Error{LimitExceeded} prefixed by `name`.
ExrLayout checkExrLayout(const ExrPartHeader& header, const ExrRules& rules, std::uint64_t fileBytes,
                         const std::string& name);

} // namespace rt
