#pragma once
#include "tools/rt-compare/compared_region.h"
#include "tools/rt-compare/finding.h"
#include "tools/rt-compare/layers.h"

#include <optional>
#include <vector>

namespace rt {

/// Which parts of the pictures to compare, and what may differ in their structure.
struct PairOptions {
    RegionOptions region;
    ChannelSelection channels;
    AllowedKinds allowed;
};

/// Two pictures that were cut to the same pixels: what a mask takes out is 0 in both.
struct PreparedPair {
    Picture a, b;                        ///< after crop, padding and mask
    std::vector<ComparedRegion> regions; ///< for each pair of parts
    std::vector<LayerPair> layers;       ///< in the order of Comparison::layers; points into a and b
};

/// Of the first part; nothing if it does not say.
std::optional<int> samplesPerPixel(const Picture& picture);

/// Names what `a` and `b` differ in beside their values, as findings that fail unless their kind is allowed,
/// and cuts both to the pixels to be compared. Where a differing data window is allowed, pixels outside of
/// one are 0. Where the pictures cannot be compared, no layers come out. Throws as regionOf() does.
PreparedPair preparePair(Picture&& a, Picture&& b, const PairOptions& options, const Picture* mask,
                         std::vector<Finding>& findings);

} // namespace rt
