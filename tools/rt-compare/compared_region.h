#pragma once
#include "formats/picture.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace rt {

/// Which pixels to compare, in coordinates of the data window.
struct RegionOptions {
    std::optional<PixelBox> crop;
    std::vector<PixelBox> ignored;
};

/// Which pixels of a part are compared.
struct ComparedRegion {
    PixelBox box;                      ///< what the channels of the part hold: width*height values each
    std::vector<std::uint8_t> ignored; ///< 1 = not compared, one per pixel of the box; empty: all are
    std::uint64_t ignoredCount = 0;

    bool isCompared(std::size_t pixel) const { return ignored.empty() || !ignored[pixel]; }
    std::uint64_t comparedCount() const { return box.pixelCount() - ignoredCount; }
};

/// The region of two parts with these data windows. Pixels where all channels of the mask (not A) are 0 are
/// ignored; nullptr: none. Throws Error{InvalidContent} if the mask does not have the size of both windows
/// together or is not finite, Error{LimitExceeded} if these are too far from each other.
ComparedRegion regionOf(const PixelBox& a, const PixelBox& b, const RegionOptions& options,
                        const Picture* mask);

/// Cuts a part to the pixels of `box`, or fills it up with zeros.
void moveTo(PicturePart& part, const PixelBox& box);

/// moveTo() its box; ignored pixels become 0.
void cutTo(PicturePart& part, const ComparedRegion& region);

} // namespace rt
