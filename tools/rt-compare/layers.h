#pragma once
#include "tools/rt-compare/comparison.h"

#include "formats/picture.h"

#include <string>
#include <vector>

namespace rt {

struct ChannelPair {
    std::string name; ///< as in ChannelComparison
    const ImageChannel* a = nullptr;
    const ImageChannel* b = nullptr; ///< of the same size and kind (numbers or uint) as a
};

/// The channels of one LayerComparison. Channels of color layers stand in the order R, G, B, A, or Y, A.
struct LayerPair {
    std::size_t part = 0; ///< of the pictures
    std::string name;
    LayerKind kind = LayerKind::Color;
    std::vector<ChannelPair> channels;

    /// By the last part of the channel's name: "R" finds "albedo.R"; nullptr if absent.
    const ChannelPair* find(const std::string& lastName) const;
};

/// Names of channels or layers.
struct ChannelSelection {
    std::vector<std::string> only, without; ///< empty: all, none
};

/// A channel's name in two: "albedo" and "R" of "albedo.R"; "" and "Z" of "Z".
struct ChannelName {
    std::string layer, last;
};
ChannelName splitChannelName(const std::string& name);

/// Groups the channels that both images have, as numbers or as uint in both, into layers: what
/// LayerComparison describes. `prefix` ("part/") goes before every name.
std::vector<LayerPair> pairLayers(const Image& a, const Image& b, std::size_t part,
                                  const std::string& prefix);

/// Names channels that one image lacks, that are called otherwise in it or that are uint in one only.
std::vector<std::string> describeChannelDifferences(const Image& a, const Image& b,
                                                    const std::string& prefix);

/// Those of `names` that mean no channel of either picture.
std::vector<std::string> unknownNames(const Picture& a, const Picture& b,
                                      const std::vector<std::string>& names);

/// Removes the channels that the selection leaves out; `where` is the name of their layer or their own.
void selectChannels(Image& image, const ChannelSelection& selection);

} // namespace rt
