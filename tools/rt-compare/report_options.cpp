#include "tools/rt-compare/report_options.h"

#include "common/command_line.h"
#include "common/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr double kMaxStops = 100.0;
constexpr double kMaxExposures = 64.0;

ExposureRange parseExposures(const std::string& text) {
    const auto count = static_cast<std::size_t>(std::ranges::count(text, ',')) + 1;
    const std::vector<double> v = parseNumbers(text, count == 3 ? 3 : 2, "--exposures");
    const double steps = count == 3 ? v[2] : v[0] == v[1] ? 1.0 : std::max(2.0, std::ceil(v[1] - v[0]));
    if (v[1] < v[0] || std::abs(v[0]) > kMaxStops || std::abs(v[1]) > kMaxStops)
        throw Error(ErrorKind::Usage,
                    fmt::format("--exposures: '{}' does not go from a lower to a higher number "
                                "of stops between -{:g} and {:g}",
                                text, kMaxStops, kMaxStops));
    if (steps != std::floor(steps) || steps < 1.0 || steps > kMaxExposures)
        throw Error(ErrorKind::Usage,
                    fmt::format("--exposures: {:g} exposures; their number must be from 1 to {:g}", steps,
                                kMaxExposures));
    return {v[0], v[1], static_cast<unsigned>(steps)};
}

HeatFigure parseHeat(const std::string& text) {
    return text == "ssim" ? HeatFigure::Ssim : text == "abs" ? HeatFigure::Abs : HeatFigure::Flip;
}

// The metrics that are only computed where they are asked for.
std::vector<std::string> costlyMetrics() {
    std::vector<std::string> names;
    for (const MetricTraits& traits : kMetrics)
        if (traits.of == MetricOf::Colors) names.push_back(traits.shortName());
    return names;
}

void askFor(Metric metric, PerceptionOptions& perception) {
    perception.flip |= metric == Metric::Flip;
    perception.ssim |= metric == Metric::Ssim;
    perception.msSsim |= metric == Metric::MsSsim;
}

} // namespace

std::vector<std::string> ReportOptions::outputs() const {
    std::vector<std::string> paths = heatPaths;
    paths.push_back(junitPath);
    paths.push_back(htmlPath);
    return paths;
}

CLI::Option* namesOption(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                         const std::string& help, const std::string& group) {
    return app.add_option(option, names, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAMES")
        ->group(group);
}

void addReportOptions(CLI::App& app, ReportTexts& texts, ReportOptions& reports,
                      PerceptionOptions& perception) {
    const std::string seen = "What is seen of colors; takes longer than all other figures";
    const std::vector<std::string> metrics = costlyMetrics();
    namesOption(app, "--metrics", texts.metrics,
                fmt::format("Report these too: {}; limits on them imply them", fmt::join(metrics, ", ")),
                seen)
        ->check(CLI::IsMember(metrics).description(""));
    app.add_option("--pixels-per-degree", perception.pixelsPerDegree,
                   "Of the observer that FLIP stands for (default 67.02: 0.7 m from a screen 0.7 m and 3840 "
                   "pixels wide)")
        ->check(numberBetween(1.0, 1000.0))
        ->type_name("X")
        ->group(seen);
    app.add_option(
           "--exposures", texts.exposures,
           "Stops at which FLIP looks at linear images (default: found from the reference's brightness)")
        ->type_name("START,STOP[,COUNT]")
        ->group(seen);
    const std::string group = "Reports";
    app.add_option(
           "-o,--output", reports.heatPaths,
           "Error map as .png or .exr, the latter with all errors as channels; may be given several times")
        ->allow_extra_args(false)
        ->type_name("FILE")
        ->group(group);
    app.add_option("--heat", texts.heat,
                   "What the colors of -o show: flip (default), ssim or abs, the largest |a-b|")
        ->check(CLI::IsMember({"flip", "ssim", "abs"}).description(""))
        ->type_name("NAME")
        ->group(group);
    app.add_option("--html", reports.htmlPath,
                   "One page with both images, their differences and all figures, for a browser")
        ->type_name("FILE")
        ->group(group);
    app.add_option("--junit", reports.junitPath,
                   "Verdicts as test cases for CI systems; - for standard output")
        ->type_name("FILE")
        ->group(group);
}

void readReportOptions(const ReportTexts& texts, const std::vector<Limit>& limits, ReportOptions& reports,
                       PerceptionOptions& perception) {
    for (const MetricTraits& traits : kMetrics)
        if (std::ranges::find(texts.metrics, traits.shortName()) != texts.metrics.end())
            askFor(traits.metric, perception);
    for (const Limit& limit : limits) askFor(limit.metric, perception);
    if (!texts.exposures.empty()) perception.exposures = parseExposures(texts.exposures);
    reports.heat = parseHeat(texts.heat);
    for (const std::string& path : reports.heatPaths)
        if (!imageFileType(path))
            throw Error(
                ErrorKind::Usage,
                fmt::format("{}: error maps are written as .exr or .png; change the extension", path));
    if (!texts.heat.empty() && reports.heatPaths.empty())
        throw Error(ErrorKind::Usage, "--heat says what -o shows; name a file with -o");
    perception.flip |=
        !reports.htmlPath.empty() || (!reports.heatPaths.empty() && reports.heat == HeatFigure::Flip);
    perception.ssim |= !reports.htmlPath.empty();
    perception.msSsim |= !reports.htmlPath.empty();
    perception.ssimMap = !reports.heatPaths.empty() && reports.heat == HeatFigure::Ssim;
}

} // namespace rt
