#pragma once
#include "tools/rt-compare/prepared_pair.h"

#include <vector>

namespace rt {

/// What is measured beside the means.
struct MetricOptions {
    std::vector<double> percents{50.0, 90.0, 99.0, 99.9};  ///< ascending, in (0, 100]
    std::vector<double> thresholds{0.0, 1e-3, 1e-2, 1e-1}; ///< ascending, the first one 0
    double peak = 1.0;                                     ///< of PSNR
    std::size_t worst = 5;                                 ///< pixels to list
};

/// All figures of a layer but SSIM and FLIP, in double precision. Same input, same bits, on any number of
/// threads. Sources: relative MSE, Rousselle et al. 2011; SMAPE as in Vogels et al. 2018; percentiles are
/// those of the nearest rank: the least |a - b| that so many per cent of the values do not exceed.
LayerComparison measureLayer(const LayerPair& layer, const ComparedRegion& focus,
                             const MetricOptions& options);

} // namespace rt
