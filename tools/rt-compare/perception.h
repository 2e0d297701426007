#pragma once
#include "tools/rt-compare/flip.h"
#include "tools/rt-compare/prepared_pair.h"

#include <optional>
#include <vector>

namespace rt {

/// What is found out of color layers only where it is asked for, because it takes longer than all the rest.
struct PerceptionOptions {
    bool flip = false, ssim = false, msSsim = false;
    bool ssimMap = false;
    double pixelsPerDegree = kDefaultPixelsPerDegree;
    std::optional<ExposureRange> exposures; ///< of HDR FLIP; absent: automatic
};

/// Errors of each pixel of a layer, 0 where pixels are ignored; empty if they were not asked for.
struct PerceptionMaps {
    std::vector<float> flip;
    std::vector<float> ssim; ///< 1 = alike; mean over the channels
};

/// Fills `flip`, `ssim` and `msSsim` of the layers of colours (R, G, B or Y) as far as they are asked for;
/// pictures too small for a similarity get a note and no value. The maps are in the order of the layers.
/// Display pictures are compared as they are, FLIP of linear ones is HDR-FLIP, and their similarity is that
/// of sRGB(v / (1 + v)), which no brightness leaves.
std::vector<PerceptionMaps> addPerception(const PreparedPair& pair, const PerceptionOptions& options,
                                          Comparison& comparison);

} // namespace rt
