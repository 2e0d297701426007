#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rt {

/// Where a fault is put: the channels of a layer, without opacity.
struct FaultPlace {
    std::string layer; ///< as in LayerComparison
    LayerKind kind = LayerKind::Color;
    std::size_t part = 0;
    bool isFirstOfPart = false;
    std::vector<std::size_t> channels; ///< of the part's image
    std::size_t pixel = 0;             ///< of the part's image, one that is compared: for faults of one pixel
};

struct Fault {
    std::string name;
    std::optional<FindingKind> kind; ///< what it must lead to whatever the limits; nothing: they decide
    std::function<void(Image& image, const FaultPlace& place)> inject;
};

/// A place for each layer of `picture` that has pixels to compare. `pair` is the picture prepared against
/// itself.
std::vector<FaultPlace> faultPlaces(const Picture& picture, const PreparedPair& pair);

/// What may be put into such a place.
std::vector<Fault> faultsFor(const FaultPlace& place);

} // namespace rt
