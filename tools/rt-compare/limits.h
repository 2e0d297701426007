#pragma once
#include "tools/rt-compare/comparison.h"

#include <array>
#include <string>
#include <vector>

namespace rt {

/// The layers that have a metric: colors only, all but ids, or every one.
enum class MetricOf { Colors, Numbers, All };

/// All that options, checks and reports know of a metric.
struct MetricTraits {
    Metric metric;
    const char* option; ///< "--max-..." or "--min-..."
    const char* name;   ///< for people; {:g} stands for Limit::parameter
    const char* help;
    MetricOf of;
    bool isAtLeast = false;  ///< passes from the limit on, not up to it
    bool isFraction = false; ///< of pixels, or a mean of values from 0 to 1
    bool hasParameter = false;
    double ErrorFigures::*figure = nullptr; ///< where it is a figure of its own

    /// As --metrics has it: "flip".
    const char* shortName() const { return option + 6; }
};

/// In the order of Metric.
inline constexpr std::array<MetricTraits, 13> kMetrics{{
    {.metric = Metric::MaxAbs,
     .option = "--max-abs",
     .name = "maximum |a-b|",
     .help = "Largest |a-b| that passes",
     .of = MetricOf::Numbers,
     .figure = &ErrorFigures::maxAbs},
    {.metric = Metric::Mae,
     .option = "--max-mae",
     .name = "MAE",
     .help = "Largest mean of |a-b| that passes",
     .of = MetricOf::Numbers,
     .figure = &ErrorFigures::mae},
    {.metric = Metric::Mse,
     .option = "--max-mse",
     .name = "MSE",
     .help = "Largest mean of (a-b)^2 that passes",
     .of = MetricOf::Numbers,
     .figure = &ErrorFigures::mse},
    {.metric = Metric::Rmse,
     .option = "--max-rmse",
     .name = "RMSE",
     .help = "Largest root mean square error that passes",
     .of = MetricOf::Numbers,
     .figure = &ErrorFigures::rmse},
    {.metric = Metric::RelMse,
     .option = "--max-relmse",
     .name = "relMSE",
     .help = "Largest mean of (a-b)^2 / (b^2 + 0.01) that passes",
     .of = MetricOf::Numbers,
     .figure = &ErrorFigures::relMse},
    {.metric = Metric::Smape,
     .option = "--max-smape",
     .name = "SMAPE",
     .help = "Largest mean of |a-b| / (|a| + |b| + 0.01) that passes",
     .of = MetricOf::Numbers,
     .isFraction = true,
     .figure = &ErrorFigures::smape},
    {.metric = Metric::Percentile,
     .option = "--max-percentile",
     .name = "percentile {:g} of |a-b|",
     .help = "P:X: P % of the values may differ by X at most",
     .of = MetricOf::Numbers,
     .hasParameter = true},
    {.metric = Metric::Over,
     .option = "--max-over",
     .name = "fraction of pixels over {:g}",
     .help = "T:F: a fraction F of the pixels may differ by more than T",
     .of = MetricOf::Numbers,
     .isFraction = true,
     .hasParameter = true},
    {.metric = Metric::Differing,
     .option = "--max-differing",
     .name = "fraction of pixels that differ",
     .help = "Fraction of the pixels that may differ at all",
     .of = MetricOf::All,
     .isFraction = true},
    {.metric = Metric::Flip,
     .option = "--max-flip",
     .name = "FLIP",
     .help = "Largest mean FLIP that passes, 0 to 1",
     .of = MetricOf::Colors,
     .isFraction = true},
    {.metric = Metric::Psnr,
     .option = "--min-psnr",
     .name = "PSNR",
     .help = "Least PSNR in dB that passes",
     .of = MetricOf::Numbers,
     .isAtLeast = true,
     .figure = &ErrorFigures::psnr},
    {.metric = Metric::Ssim,
     .option = "--min-ssim",
     .name = "SSIM",
     .help = "Least SSIM that passes, 1 = alike",
     .of = MetricOf::Colors,
     .isAtLeast = true,
     .isFraction = true},
    {.metric = Metric::MsSsim,
     .option = "--min-ms-ssim",
     .name = "MS-SSIM",
     .help = "Least MS-SSIM that passes",
     .of = MetricOf::Colors,
     .isAtLeast = true,
     .isFraction = true},
}};

constexpr const MetricTraits& traitsOf(Metric metric) {
    return kMetrics[static_cast<std::size_t>(metric)];
}
static_assert([] {
    for (std::size_t i = 0; i < kMetrics.size(); ++i)
        if (kMetrics[i].metric != static_cast<Metric>(i)) return false;
    return kMetrics.back().metric == Metric::MsSsim;
}());

/// Parses "[NAME=]X", for metrics with a parameter "[NAME=]P:X". Throws Error{Usage} naming the option.
Limit parseLimit(Metric metric, const std::string& text);

/// "RMSE", "percentile 99 of |a-b|", "fraction of pixels over 0.01".
std::string metricName(const Limit& limit);

/// Fills comparison.checks and adds a finding for each limit that does not hold or whose name no layer and no
/// channel has. The limit with the most precise name counts: a layer's own, then "*", then none; of several
/// with the same name the strictest. A layer of colours without a limit must be equal, unless `tolerant`;
/// another layer of numbers too, unless `tolerant` or some limit has no name; ids always. So must
/// channels of a layer of which only others have limits, and opacity beside limits on what is seen alone. A
/// limit that names a layer without such a figure is a finding.
void checkLimits(const std::vector<Limit>& limits, bool tolerant, Comparison& comparison);

/// Whether a layer's or channel's name is meant by `where`: "Z" means "Z" and every part's "part/Z".
bool isNamed(const std::string& name, const std::string& where);

} // namespace rt
