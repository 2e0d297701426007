#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <string>
#include <vector>

namespace rt {

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

/// Removes the channels that the options leave out; `where` is the name of their layer or their own.
void selectChannels(Image& image, const FocusOptions& options);

} // namespace rt
