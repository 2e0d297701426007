#include "tools/rt-compare/heat_map.h"

#include "formats/heat_color.h"

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

std::vector<float> absoluteErrors(const ChannelPair& channel) {
    std::vector<float> errors;
    for (std::size_t i = 0; i < channel.a->uints.size(); ++i)
        errors.push_back(channel.a->uints[i] == channel.b->uints[i] ? 0.0f : 1.0f);
    for (std::size_t i = 0; i < channel.a->values.size(); ++i)
        errors.push_back(std::abs(channel.a->values[i] - channel.b->values[i]));
    return errors;
}

std::vector<float> largestErrors(const PreparedPair& pair, const LayerPair& layer) {
    std::vector<float> largest(pair.regions[layer.part].box.pixelCount());
    for (const ChannelPair& channel : layer.channels) {
        const std::vector<float> errors = absoluteErrors(channel);
        for (std::size_t i = 0; i < errors.size(); ++i)
            if (std::isfinite(largest[i]) && !(errors[i] <= largest[i])) largest[i] = errors[i]; // NaN too
    }
    float most = 0.0f;
    for (const float error : largest)
        if (std::isfinite(error)) most = std::max(most, error);
    for (float& error : largest) error = std::isfinite(error) ? (most > 0.0f ? error / most : 0.0f) : 1.0f;
    return largest;
}

// 256 of them, linear light: a table, since a picture has millions of pixels.
std::vector<glm::vec3> linearHeatColors() {
    std::vector<glm::vec3> colors;
    for (int i = 0; i < 256; ++i) {
        const glm::dvec3 color = heatColor(i / 255.0);
        colors.emplace_back(decodeSrgb(color.r), decodeSrgb(color.g), decodeSrgb(color.b));
    }
    return colors;
}

void addChannel(Image& image, const std::string& name, std::vector<float>&& values) {
    image.channels.push_back({name, ImageChannel::Type::Float, std::move(values), {}});
}

void addColors(Image& image, const std::vector<float>& heat) {
    const std::vector<glm::vec3> colors = linearHeatColors();
    for (int c = 0; c < 3; ++c) {
        std::vector<float> values;
        values.reserve(heat.size());
        for (const float t : heat)
            values.push_back(colors[static_cast<std::size_t>(std::lround(t * 255.0f))][c]);
        addChannel(image, std::string(1, "RGB"[c]), std::move(values));
    }
}

} // namespace

std::vector<float> heatValues(const PreparedPair& pair, const PerceptionMaps& maps, std::size_t layer,
                              HeatFigure figure) {
    if (figure == HeatFigure::Flip && !maps.flip.empty()) return maps.flip;
    if (figure == HeatFigure::Ssim && !maps.ssim.empty()) {
        std::vector<float> values;
        for (const float similarity : maps.ssim) values.push_back(std::clamp(1.0f - similarity, 0.0f, 1.0f));
        return values;
    }
    return largestErrors(pair, pair.layers[layer]);
}

Image heatMap(const PreparedPair& pair, const std::vector<PerceptionMaps>& maps, HeatFigure figure) {
    Image image;
    image.width = pair.regions.front().box.width();
    image.height = pair.regions.front().box.height();
    std::optional<std::size_t> shown;
    for (std::size_t i = 0; i < pair.layers.size(); ++i) {
        const LayerPair& layer = pair.layers[i];
        if (layer.part != 0) continue;
        const bool isBetter =
            shown && pair.layers[*shown].kind != LayerKind::Color && layer.kind == LayerKind::Color;
        if (!shown || isBetter) shown = i;
        for (const ChannelPair& channel : layer.channels)
            addChannel(image, "error." + channel.name, absoluteErrors(channel));
        const auto nameOf = [&](const std::string& map) {
            return image.find(map) ? map + "." + layer.name : map;
        };
        if (!maps[i].flip.empty()) addChannel(image, nameOf("flip"), std::vector(maps[i].flip));
        if (!maps[i].ssim.empty()) addChannel(image, nameOf("ssim"), std::vector(maps[i].ssim));
    }
    if (shown) addColors(image, heatValues(pair, maps[*shown], *shown, figure));
    std::ranges::sort(image.channels, {}, &ImageChannel::name);
    return image;
}

} // namespace rt
