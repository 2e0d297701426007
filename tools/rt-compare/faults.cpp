#include "tools/rt-compare/faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rt {
namespace {

using Values = std::vector<float>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

void shiftRight(Values& values, std::size_t width) {
    for (std::size_t i = values.size(); i-- > 1;)
        if (i % width != 0) values[i] = values[i - 1];
}

Fault onEach(const char* name, std::optional<FindingKind> kind,
             std::function<void(Values& values, std::size_t width)> change) {
    return {name, kind, [change](Image& image, const FaultPlace& place) {
                for (const std::size_t c : place.channels) change(image.channels[c].values, image.width);
            }};
}

Fault onValues(const char* name, std::optional<FindingKind> kind, float (*change)(float)) {
    return onEach(name, kind, [change](Values& values, std::size_t) {
        std::ranges::transform(values, values.begin(), change);
    });
}

Fault onOne(const char* name, float value) {
    return {name, FindingKind::NonFinite, [value](Image& image, const FaultPlace& place) {
                image.channels[place.channels.front()].values[place.pixel] = value;
            }};
}

std::vector<Fault> faultsOfNumbers() {
    return {
        onOne("one NaN", kNan),
        onValues("all NaN", FindingKind::NonFinite, [](float) { return kNan; }),
        onOne("one +Inf", kInf),
        onOne("one -Inf", -kInf),
        onValues("black frame", FindingKind::Black, [](float) { return 0.0f; }),
        onEach("shift by one pixel", {}, shiftRight),
        {"channels swapped",
         {},
         [](Image& image, const FaultPlace& place) {
             if (place.channels.size() > 1)
                 std::swap(image.channels[place.channels[0]].values,
                           image.channels[place.channels[1]].values);
         }},
        onValues("gamma 2.2 applied", {}, [](float v) { return v > 0.0f ? std::pow(v, 1.0f / 2.2f) : v; }),
        onValues("error of 1 %", {},
                 [](float v) { return std::isfinite(v) ? std::clamp(v * 1.01f, -kLargest, kLargest) : v; }),
        onValues("error of 1 ulp", {},
                 [](float v) { return std::isfinite(v) ? std::nextafter(v, kLargest) : v; }),
    };
}

std::vector<Fault> faultsOfIds() {
    return {{"one id changed",
             {},
             [](Image& image, const FaultPlace& place) {
                 ++image.channels[place.channels.front()].uints[place.pixel];
             }},
            {"all ids 0", {}, [](Image& image, const FaultPlace& place) {
                 std::ranges::fill(image.channels[place.channels.front()].uints, 0u);
             }}};
}

// The compared pixel of a region that is next to its middle, in an image with this data window.
std::optional<std::size_t> middlePixel(const ComparedRegion& region, const PixelBox& dataWindow) {
    const std::size_t width = region.box.width(), count = region.box.pixelCount();
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = (count / 2 + k) % count;
        if (!region.isCompared(i)) continue;
        const auto x = static_cast<std::size_t>(region.box.x0 - dataWindow.x0) + i % width;
        const auto y = static_cast<std::size_t>(region.box.y0 - dataWindow.y0) + i / width;
        return y * dataWindow.width() + x;
    }
    return std::nullopt;
}

} // namespace

std::vector<FaultPlace> faultPlaces(const Picture& picture, const PreparedPair& pair) {
    std::vector<FaultPlace> places;
    for (const LayerPair& layer : pair.layers) {
        const PicturePart& part = picture.parts[layer.part];
        const std::optional<std::size_t> pixel = middlePixel(pair.regions[layer.part], part.dataWindow);
        if (!pixel) continue;
        FaultPlace place{layer.name, layer.kind, layer.part, false, {}, *pixel};
        for (const ChannelPair& channel : layer.channels)
            if (layer.kind != LayerKind::Color || splitChannelName(channel.a->name).last != "A")
                place.channels.push_back(
                    static_cast<std::size_t>(part.image.find(channel.a->name) - part.image.channels.data()));
        if (place.channels.empty()) continue;
        place.isFirstOfPart = places.empty() || places.back().part != place.part;
        places.push_back(std::move(place));
    }
    return places;
}

std::vector<Fault> faultsFor(const FaultPlace& place) {
    std::vector<Fault> faults = place.kind == LayerKind::Ids ? faultsOfIds() : faultsOfNumbers();
    faults.push_back({"channel renamed", FindingKind::Channels, [](Image& image, const FaultPlace& at) {
                          image.channels[at.channels.front()].name += "_";
                      }});
    if (place.isFirstOfPart)
        faults.push_back(
            {"channel of zeros added", FindingKind::Channels, [](Image& image, const FaultPlace&) {
                 image.channels.push_back({"zz", ImageChannel::Type::Float, Values(image.pixelCount()), {}});
             }});
    return faults;
}

} // namespace rt
