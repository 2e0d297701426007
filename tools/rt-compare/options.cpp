#include "tools/rt-compare/options.h"

#include "common/binary_io.h"
#include "common/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

using Texts = std::vector<std::string>;

struct OptionTexts {
    std::array<Texts, kMetrics.size()> limits;
    Texts allowed, ignored;
    std::string crop, percentiles, thresholds, compression, nonFinite;
    ReportTexts reports;
};

void addLimits(CLI::App& app, OptionTexts& texts, Options& options) {
    const std::string group =
        "Limits: [NAME=]X of a layer (color, Z, albedo, ...), a channel (N.X) or all ('*'); "
        "without NAME, of every layer of colors; of several the strictest. What has none must be equal: by "
        "default all, beside a channel's limit the layer's other channels, beside FLIP and SSIM opacity";
    for (std::size_t i = 0; i < kMetrics.size(); ++i)
        app.add_option(kMetrics[i].option, texts.limits[i], kMetrics[i].help)
            ->allow_extra_args(false)
            ->type_name("[NAME=]X")
            ->group(group);
    app.add_option("--peak", options.compare.metrics.peak, "Value that PSNR counts as full scale (default 1)")
        ->check(numberBetween(1e-30, 1e30))
        ->type_name("X")
        ->group(group);
}

void addVerdict(CLI::App& app, OptionTexts& texts, Options& options) {
    const std::string group = "Verdict";
    Texts names, helps;
    for (const FindingTraits& traits : kFindings) {
        if (!traits.isAllowable) continue;
        names.push_back(traits.name);
        helps.push_back(fmt::format("{} ({})", traits.name, traits.help));
    }
    namesOption(app, "--allow", texts.allowed,
                fmt::format("Differences that do not fail: {}", fmt::join(helps, ", ")), group)
        ->check(CLI::IsMember(names).description(""));
    app.add_option("--allow-nonfinite", texts.nonFinite,
                   "same: NaN and infinities pass where both images have the same")
        ->check(CLI::IsMember({"same"}).description(""))
        ->type_name("same")
        ->group(group);
    app.add_flag(
           "--noise", options.compare.noise.on,
           "Instead of wanting equal colors, test whether a and b, renders with two seeds, differ by "
           "more than "
           "noise: by their variance channels and samplesPerPixel, without which a difference fails, and "
           "region by region")
        ->group(group);
    app.add_option("--second-seed", options.secondPath,
                   "As --noise, with the noise known from another render of b with a third seed; a folder "
                   "for folders")
        ->type_name("FILE")
        ->group(group);
    app.add_option("--noise-level", options.compare.noise.level,
                   "Probability of a false alarm by noise (default 1e-3)")
        ->check(numberBetween(1e-12, 0.5))
        ->type_name("P")
        ->group(group);
}

void addSelection(CLI::App& app, OptionTexts& texts, Options& options) {
    const std::string group = "What is compared";
    app.add_option("--crop", texts.crop, "Only the pixels from x0,y0 up to but without x1,y1")
        ->type_name("x0,y0,x1,y1")
        ->group(group);
    app.add_option("--ignore", texts.ignored, "Not these pixels; may be given several times")
        ->allow_extra_args(false)
        ->type_name("x0,y0,x1,y1")
        ->group(group);
    app.add_option("--mask", options.maskPath, "Not the pixels that are 0 in this image")
        ->type_name("FILE")
        ->group(group);
    ChannelSelection& channels = options.compare.channels;
    namesOption(app, "--channels", channels.only, "Only these channels or layers", group);
    namesOption(app, "--ignore-channels", channels.without, "Not these channels or layers", group);
}

void addFigures(CLI::App& app, OptionTexts& texts, Options& options) {
    const std::string group = "Figures";
    app.add_option("--percentiles", texts.percentiles, "Of |a-b| to report (default 50,90,99,99.9)")
        ->type_name("P,...")
        ->group(group);
    app.add_option("--thresholds", texts.thresholds,
                   "Report how many pixels differ by more than these (default 0.001,0.01,0.1)")
        ->type_name("T,...")
        ->group(group);
    app.add_option("--worst", options.compare.metrics.worst, "Worst pixels to list per layer (default 5)")
        ->check(numberBetween(0, 1000))
        ->type_name("N")
        ->group(group);
    app.add_option(
           "--max-shift", options.compare.maxShift,
           "Pixels within which the best shift of images that differ is looked for; 0 = not (default 8)")
        ->check(numberBetween(0, 64))
        ->type_name("N")
        ->group(group);
    app.add_flag("--self-test", options.selfTest,
                 "Inject faults into each layer of A and show that they are caught, or are below the limits "
                 "as they "
                 "should be; not with --noise")
        ->group(group);
}

void addReading(CLI::App& app, OptionTexts& texts, Options& options) {
    const std::string group = "Reading";
    app.add_option("--list", options.listPath,
                   "Compare the pairs of this file: two names on each line; - for standard input")
        ->type_name("FILE")
        ->group(group);
    app.add_option("--allow-compression", texts.compression,
                   "all: read EXR files compressed with PIZ, PXR24, B44, DWA too; only files that you trust")
        ->check(CLI::IsMember({"all"}).description(""))
        ->type_name("all")
        ->group(group);
    app.add_option("--max-pixels", options.reading.maxPixels, "Refuse larger images (default 2^28)")
        ->check(numberBetween(1, double(std::uint64_t(1) << 40)))
        ->type_name("N")
        ->group(group);
}

std::vector<double> parseList(const std::string& text, const std::string& option, double high) {
    const auto count = static_cast<std::size_t>(std::ranges::count(text, ',')) + 1;
    std::vector<double> values = parseNumbers(text, count, option);
    for (const double value : values)
        if (value < 0.0 || value > high)
            throw Error(ErrorKind::Usage,
                        fmt::format("{}: {} is not between 0 and {:g}", option, value, high));
    return values;
}

PixelBox parseBox(const std::string& text, const std::string& option) {
    const std::vector<double> v = parseNumbers(text, 4, option);
    constexpr double kMax = 1 << 30;
    const auto isPlace = [](double value) { return std::abs(value) <= kMax && value == std::floor(value); };
    if (!std::ranges::all_of(v, isPlace) || v[2] <= v[0] || v[3] <= v[1])
        throw Error(
            ErrorKind::Usage,
            fmt::format("{}: '{}' is no rectangle: x0,y0 is its first pixel, x1,y1 the one beyond its last",
                        option, text));
    const auto at = [&](std::size_t i) { return static_cast<std::int32_t>(v[i]); };
    return {at(0), at(1), at(2), at(3)};
}

void insertSorted(std::vector<double>& values, double value) {
    const auto place = std::ranges::lower_bound(values, value);
    if (place == values.end() || *place != value) values.insert(place, value);
}

void readLimits(const OptionTexts& texts, CompareOptions& options) {
    for (std::size_t i = 0; i < kMetrics.size(); ++i)
        for (const std::string& text : texts.limits[i])
            options.limits.push_back(parseLimit(kMetrics[i].metric, text));
    for (const Limit& limit : options.limits) {
        if (limit.metric == Metric::Percentile) insertSorted(options.metrics.percents, limit.parameter);
        if (limit.metric == Metric::Over) insertSorted(options.metrics.thresholds, limit.parameter);
    }
}

void readTexts(const OptionTexts& texts, Options& options) {
    MetricOptions& metrics = options.compare.metrics;
    if (!texts.percentiles.empty()) metrics.percents.clear();
    if (!texts.thresholds.empty()) metrics.thresholds = {0.0};
    if (!texts.percentiles.empty())
        for (const double percent : parseList(texts.percentiles, "--percentiles", 100.0))
            insertSorted(metrics.percents, percent);
    if (!texts.thresholds.empty())
        for (const double threshold : parseList(texts.thresholds, "--thresholds", 1e30))
            insertSorted(metrics.thresholds, threshold);
    readLimits(texts, options.compare);
    for (const FindingTraits& traits : kFindings)
        if (std::ranges::find(texts.allowed, traits.name) != texts.allowed.end())
            options.compare.allowed.insert(traits.kind);
    if (!options.secondPath.empty()) options.compare.noise.on = true;
    options.compare.allowSameNonFinite = !texts.nonFinite.empty();
    options.reading.allCompressions = !texts.compression.empty();
    if (!texts.crop.empty()) options.compare.region.crop = parseBox(texts.crop, "--crop");
    for (const std::string& text : texts.ignored)
        options.compare.region.ignored.push_back(parseBox(text, "--ignore"));
}

void requireInputs(const Options& options) {
    const bool hasA = !options.pathA.empty(), hasB = !options.pathB.empty();
    if (options.selfTest) {
        if (!hasA || hasB || !options.listPath.empty())
            throw Error(ErrorKind::Usage, "--self-test takes one image");
    } else if (!options.listPath.empty()) {
        if (hasA) throw Error(ErrorKind::Usage, "--list names the images; leave out the others");
    } else if (!hasB) {
        throw Error(ErrorKind::Usage,
                    "two images are wanted: the one under test and the reference; see rt-compare --help");
    }
    if (options.pathA == "-" && options.pathB == "-")
        throw Error(ErrorKind::Usage, "standard input holds one image; name a file for the other");
}

void requireOutputs(const Options& options) {
    const std::vector<std::string> outputs = outputsOf(options);
    const CommonOptions& common = options.common;
    const bool ofPairs =
        std::ranges::any_of(outputs, [&](const auto& path) { return path != common.jsonPath; });
    if (options.selfTest && (ofPairs || common.ifChanged))
        throw Error(ErrorKind::Usage,
                    "--self-test compares no two images; leave out -o, --html, --junit, --depfile and "
                    "--if-changed");
    const std::vector<std::string> inputs{options.pathA, options.pathB, options.listPath, options.maskPath,
                                          options.secondPath};
    requireDistinctPaths(inputs, outputs);
    checkBuildOptions(common, inputs, outputs);
    for (const std::string& path : outputs) requireWritable(path);
}

} // namespace

std::vector<std::string> outputsOf(const Options& options) {
    std::vector<std::string> outputs = options.reports.outputs();
    outputs.insert(outputs.end(), {options.common.jsonPath, options.common.depfilePath});
    std::erase(outputs, "");
    return outputs;
}

bool parseOptions(int argc, const char* const* argv, Options& options) {
    CLI::App app(
        "Compares images (EXR, PNG, JPEG, PFM, Radiance HDR), folders or sequences of them (frame.%04d.exr); "
        "exit code 0 if they agree, 1 if they differ",
        "rt-compare");
    addCommonOptions(app, options.common, "OpenEXR " RT_OPENEXR_VERSION);
    addBuildOptions(app, options.common);
    OptionTexts texts;
    app.add_option("a", options.pathA, "Image under test, a folder or a sequence; - for standard input")
        ->type_name("A");
    app.add_option("b", options.pathB, "Reference")->type_name("B");
    addLimits(app, texts, options);
    addVerdict(app, texts, options);
    addSelection(app, texts, options);
    addFigures(app, texts, options);
    addReportOptions(app, texts.reports, options.reports, options.compare.perception);
    addReading(app, texts, options);
    if (!parseCommandLine(app, argc, argv, options.common)) return false;
    readTexts(texts, options);
    readReportOptions(texts.reports, options.compare.limits, options.reports, options.compare.perception);
    requireInputs(options);
    requireOutputs(options);
    // The figures of the page and of the maps are in the JSON file too.
    options.common.making =
        makingOf(app, options.common, {"a", "b", "--list", "--mask", "--second-seed", "--html", "--junit"}) +
        (options.reports.htmlPath.empty() ? "" : "\npage") +
        (options.reports.heatPaths.empty() ? "" : "\nmaps");
    return true;
}

} // namespace rt
