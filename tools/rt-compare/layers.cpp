#include "tools/rt-compare/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace rt {
namespace {

constexpr std::string_view kColorOrder = "RGBYA";

bool isUint(const ImageChannel& channel) {
    return channel.type == ImageChannel::Type::Uint;
}

const char* kindName(const ImageChannel& channel) {
    return isUint(channel) ? "uint" : "number";
}

bool hasColor(const Image& image, const std::string& layer) {
    const auto has = [&](const char* last) {
        const ImageChannel* channel = image.find(layer.empty() ? last : layer + "." + last);
        return channel && !isUint(*channel);
    };
    if (has("R") || has("G") || has("B")) return true;
    return layer.empty() && has("Y") && !has("X"); // grey; X, Y, Z are a vector
}

bool isColor(const Image& image, const ImageChannel& channel) {
    if (isUint(channel)) return false;
    const ChannelName name = splitChannelName(channel.name);
    return name.last.size() == 1 && kColorOrder.find(name.last) != kColorOrder.npos &&
           hasColor(image, name.layer);
}

// The name of the layer that a channel belongs to, and its kind.
std::pair<std::string, LayerKind> layerOf(const Image& image, const ImageChannel& channel) {
    const ChannelName name = splitChannelName(channel.name);
    if (isUint(channel)) return {channel.name, LayerKind::Ids};
    if (isColor(image, channel)) return {name.layer.empty() ? "color" : name.layer, LayerKind::Color};
    return {name.layer.empty() || hasColor(image, name.layer) ? channel.name : name.layer, LayerKind::Data};
}

bool sameValues(const ImageChannel& a, const ImageChannel& b) {
    return a.type == b.type && a.uints == b.uints &&
           std::ranges::equal(a.values, b.values,
                              [](float x, float y) { return x == y || (x != x && y != y); });
}

bool isMeant(const Image& image, const ImageChannel& channel, const std::vector<std::string>& names) {
    return std::ranges::find(names, channel.name) != names.end() ||
           std::ranges::find(names, layerOf(image, channel).first) != names.end();
}

} // namespace

const ChannelPair* LayerPair::find(const std::string& lastName) const {
    for (const ChannelPair& channel : channels)
        if (splitChannelName(channel.a->name).last == lastName) return &channel;
    return nullptr;
}

ChannelName splitChannelName(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    if (dot == name.npos) return {"", name};
    return {name.substr(0, dot), name.substr(dot + 1)};
}

std::vector<LayerPair> pairLayers(const Image& a, const Image& b, std::size_t part,
                                  const std::string& prefix) {
    std::vector<LayerPair> layers;
    for (const ImageChannel& channel : a.channels) {
        const ImageChannel* other = b.find(channel.name);
        if (!other || isUint(channel) != isUint(*other)) continue;
        const auto [name, kind] = layerOf(a, channel);
        auto layer = std::ranges::find(layers, prefix + name, &LayerPair::name);
        if (layer == layers.end()) layer = layers.insert(layers.end(), {part, prefix + name, kind, {}});
        layer->channels.push_back({prefix + channel.name, &channel, other});
    }
    for (LayerPair& layer : layers)
        if (layer.kind == LayerKind::Color)
            std::ranges::sort(layer.channels, {}, [](const ChannelPair& channel) {
                return kColorOrder.find(splitChannelName(channel.a->name).last);
            });
    std::ranges::stable_sort(layers, {}, [&](const LayerPair& layer) {
        return layer.name == prefix + "color" ? 0 : layer.kind == LayerKind::Color ? 1 : 2;
    });
    return layers;
}

std::vector<std::string> describeChannelDifferences(const Image& a, const Image& b,
                                                    const std::string& prefix) {
    std::vector<std::string> texts;
    std::vector<const ImageChannel*> onlyB;
    for (const ImageChannel& channel : b.channels)
        if (!a.find(channel.name)) onlyB.push_back(&channel);
    for (const ImageChannel& channel : a.channels) {
        const ImageChannel* other = b.find(channel.name);
        const std::string name = "channel " + prefix + channel.name;
        if (other) {
            if (isUint(channel) != isUint(*other))
                texts.push_back(
                    fmt::format("{} is {} against {}", name, kindName(channel), kindName(*other)));
            continue;
        }
        const auto renamed = std::ranges::find_if(
            onlyB, [&](const ImageChannel* candidate) { return sameValues(channel, *candidate); });
        if (renamed == onlyB.end()) {
            texts.push_back(name + " is in the first image only");
        } else {
            texts.push_back(
                fmt::format("{} is called {}{} in the second image", name, prefix, (*renamed)->name));
            onlyB.erase(renamed);
        }
    }
    for (const ImageChannel* channel : onlyB)
        texts.push_back(fmt::format("channel {}{} is in the second image only", prefix, channel->name));
    return texts;
}

std::vector<std::string> unknownNames(const Picture& a, const Picture& b,
                                      const std::vector<std::string>& names) {
    std::vector<std::string> unknown;
    for (const std::string& name : names) {
        const auto knows = [&](const PicturePart& part) {
            return std::ranges::any_of(part.image.channels, [&](const ImageChannel& channel) {
                return isMeant(part.image, channel, {name});
            });
        };
        if (std::ranges::none_of(a.parts, knows) && std::ranges::none_of(b.parts, knows))
            unknown.push_back(name);
    }
    return unknown;
}

void selectChannels(Image& image, const ChannelSelection& selection) {
    std::vector<ImageChannel> kept;
    std::vector<bool> isKept;
    for (const ImageChannel& channel : image.channels)
        isKept.push_back((selection.only.empty() || isMeant(image, channel, selection.only)) &&
                         !isMeant(image, channel, selection.without));
    for (std::size_t i = 0; i < isKept.size(); ++i)
        if (isKept[i]) kept.push_back(std::move(image.channels[i]));
    image.channels = std::move(kept);
}

} // namespace rt
