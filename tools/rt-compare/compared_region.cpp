#include "tools/rt-compare/compared_region.h"

#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

PixelBox intersection(const PixelBox& one, const PixelBox& other) {
    return {std::max(one.x0, other.x0), std::max(one.y0, other.y0), std::min(one.x1, other.x1),
            std::min(one.y1, other.y1)};
}

PixelBox unionOf(const PixelBox& one, const PixelBox& other) {
    return {std::min(one.x0, other.x0), std::min(one.y0, other.y0), std::max(one.x1, other.x1),
            std::max(one.y1, other.y1)};
}

template <class T>
void moveValues(std::vector<T>& values, const PixelBox& from, const PixelBox& to) {
    if (values.empty()) return;
    std::vector<T> moved(to.pixelCount()); // 0 where `from` has nothing
    const PixelBox both = intersection(from, to);
    for (std::int32_t y = both.y0; y < both.y1; ++y) {
        const auto source = values.begin() + std::ptrdiff_t(y - from.y0) * from.width() + (both.x0 - from.x0);
        std::copy_n(source, both.width(),
                    moved.begin() + std::ptrdiff_t(y - to.y0) * to.width() + (both.x0 - to.x0));
    }
    values = std::move(moved);
}

void clearIgnored(PicturePart& part, const ComparedRegion& region) {
    for (ImageChannel& channel : part.image.channels)
        for (std::size_t i = 0; i < region.ignored.size(); ++i)
            if (region.ignored[i])
                (channel.values.empty() ? void(channel.uints[i] = 0) : void(channel.values[i] = 0));
}

void ignoreRectangles(const std::vector<PixelBox>& rectangles, ComparedRegion& region) {
    for (const PixelBox& rectangle : rectangles) {
        const PixelBox box = intersection(rectangle, region.box);
        for (std::int32_t y = box.y0; y < box.y1; ++y)
            std::fill_n(region.ignored.begin() + std::ptrdiff_t(y - region.box.y0) * region.box.width() +
                            (box.x0 - region.box.x0),
                        box.width(), std::uint8_t(1));
    }
}

// A mask's channels that count: numbers without opacity, or uint where there are no others.
std::vector<const ImageChannel*> maskChannels(const Image& mask) {
    std::vector<const ImageChannel*> numbers, ids;
    for (const ImageChannel& channel : mask.channels)
        if (channel.type == ImageChannel::Type::Uint)
            ids.push_back(&channel);
        else if (channel.name != "A" || mask.channels.size() == 1)
            numbers.push_back(&channel);
    return numbers.empty() ? ids : numbers;
}

// `whole` is the pictures' box before the crop, which the mask must have too.
void ignoreMasked(const Picture& mask, const PixelBox& whole, ComparedRegion& region) {
    const Image& image = mask.parts.front().image;
    if (image.width != whole.width() || image.height != whole.height())
        throw Error(ErrorKind::InvalidContent,
                    fmt::format("{}: a mask of {} x {} pixels does not fit images of {} x {}", mask.name,
                                image.width, image.height, whole.width(), whole.height()));
    const std::vector<const ImageChannel*> channels = maskChannels(image);
    for (std::size_t i = 0; i < region.ignored.size(); ++i) {
        const std::size_t x = i % region.box.width() + std::size_t(region.box.x0 - whole.x0);
        const std::size_t y = i / region.box.width() + std::size_t(region.box.y0 - whole.y0);
        const std::size_t at = y * image.width + x;
        bool isShown = false;
        for (const ImageChannel* channel : channels) {
            const double value =
                channel->values.empty() ? double(channel->uints[at]) : double(channel->values[at]);
            if (!std::isfinite(value))
                throw Error(ErrorKind::InvalidContent,
                            fmt::format("{}: the mask is not finite at x {}, y {}", mask.name, x, y));
            isShown = isShown || value != 0.0;
        }
        if (!isShown) region.ignored[i] = 1;
    }
}

} // namespace

ComparedRegion regionOf(const PixelBox& a, const PixelBox& b, const RegionOptions& options,
                        const Picture* mask) {
    const PixelBox whole = unionOf(a, b);
    ComparedRegion region;
    region.box = options.crop ? intersection(*options.crop, whole) : whole;
    if (region.box.pixelCount() == 0) region.box = {};
    // Windows that are far from each other may span more than either file holds.
    constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 28;
    const std::uint64_t most = std::max({kMaxPixels, a.pixelCount(), b.pixelCount()});
    if (region.box.pixelCount() > most)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("the data windows span {} x {} pixels, more than {}; compare a part with --crop",
                        region.box.width(), region.box.height(), most));
    if (options.ignored.empty() && !mask) return region;
    region.ignored.resize(region.box.pixelCount());
    ignoreRectangles(options.ignored, region);
    if (mask) ignoreMasked(*mask, whole, region);
    region.ignoredCount = static_cast<std::uint64_t>(std::ranges::count(region.ignored, std::uint8_t(1)));
    return region;
}

void moveTo(PicturePart& part, const PixelBox& box) {
    if (part.dataWindow == box) return;
    for (ImageChannel& channel : part.image.channels) {
        moveValues(channel.values, part.dataWindow, box);
        moveValues(channel.uints, part.dataWindow, box);
    }
    part.dataWindow = box;
    part.image.width = box.width();
    part.image.height = box.height();
}

void cutTo(PicturePart& part, const ComparedRegion& region) {
    moveTo(part, region.box);
    clearIgnored(part, region);
}

} // namespace rt
