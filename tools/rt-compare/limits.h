#pragma once
#include "tools/rt-compare/comparison.h"

#include <string>
#include <vector>

namespace rt {

/// What a figure may be at most, or of PSNR, SSIM and MS-SSIM at least.
struct Limit {
    Metric metric = Metric::Rmse;
    std::string where;      ///< a layer or channel; "*": every layer; empty: every color layer
    double parameter = 0.0; ///< Percentile: per cent; Over: threshold
    double value = 0.0;
};

/// Parses "[NAME=]X", for Percentile and Over "[NAME=]P:X". Throws Error{Usage} naming `option`.
Limit parseLimit(Metric metric, const std::string& text, const std::string& option);

/// "rmse", "percentile 99", "over 0.01".
std::string metricName(const Limit& limit);

/// Fills comparison.checks and adds a finding for each limit that does not hold or whose name no layer and no
/// channel has. The limit with the most precise name counts: a layer's own, then "*", then none. A layer of
/// colours without a limit must be equal, unless `tolerant`; another layer too, unless `tolerant` or some
/// limit has no name.
void checkLimits(const std::vector<Limit>& limits, bool tolerant, Comparison& comparison);

/// Whether a layer's or channel's name is meant by `where`: "Z" means "Z" and every part's "part/Z".
bool isNamed(const std::string& name, const std::string& where);

} // namespace rt
