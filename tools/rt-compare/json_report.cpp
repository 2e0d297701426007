#include "tools/rt-compare/json_report.h"

#include "tools/rt-compare/limits.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace rt {
namespace {

using Json = nlohmann::json;

const char* kindName(LayerKind kind) {
    return kind == LayerKind::Color ? "color" : kind == LayerKind::Data ? "data" : "ids";
}

Json boxOf(const PixelBox& box) {
    return {box.x0, box.y0, box.x1, box.y1};
}

Json describePart(const PicturePart& part) {
    Json channels = Json::array();
    for (const ImageChannel& channel : part.image.channels) channels.push_back(channel.name);
    return {{"name", part.name},
            {"dataWindow", boxOf(part.dataWindow)},
            {"displayWindow", boxOf(part.displayWindow)},
            {"channels", channels}};
}

Json describePicture(const std::string& file, const Picture& picture, const NonFiniteCounts& nonFinite) {
    Json parts = Json::array();
    for (const PicturePart& part : picture.parts) parts.push_back(describePart(part));
    Json result{{"file", file},
                {"format", picture.format},
                {"scale", picture.scale == ValueScale::Linear ? "linear" : "display"},
                {"parts", parts},
                {"nonFinitePixels", nonFinite.pixels},
                {"nan", nonFinite.nan},
                {"positiveInf", nonFinite.positiveInf},
                {"negativeInf", nonFinite.negativeInf},
                {"firstNonFinite", nullptr}};
    if (const auto& first = nonFinite.first)
        result["firstNonFinite"] = {{"channel", first->channel}, {"x", first->x}, {"y", first->y}};
    return result;
}

Json describeRange(const ValueRange& range) {
    return {{"min", range.min}, {"max", range.max}, {"mean", range.mean}};
}

Json describePercentiles(const std::vector<Percentile>& percentiles, const char* valueName) {
    Json result = Json::array();
    for (const Percentile& p : percentiles)
        result.push_back({{"percent", p.percent}, {valueName, p.absError}});
    return result;
}

Json describeFigures(const ErrorFigures& figures) {
    Json over = Json::array();
    for (const OverThreshold& o : figures.over)
        over.push_back({{"threshold", o.threshold}, {"pixels", o.pixels}, {"fraction", o.fraction}});
    return {{"values", figures.values},
            {"compared", figures.compared},
            {"maxAbs", figures.maxAbs},
            {"bias", figures.bias},
            {"mae", figures.mae},
            {"mse", figures.mse},
            {"rmse", figures.rmse},
            {"relMse", figures.relMse},
            {"smape", figures.smape},
            {"psnr", figures.psnr},
            {"a", describeRange(figures.a)},
            {"b", describeRange(figures.b)},
            {"percentiles", describePercentiles(figures.percentiles, "absError")},
            {"over", over},
            {"histogram",
             {{"lowestExponent", ErrorHistogram::kLowestExponent}, {"counts", figures.histogram.counts}}}};
}

Json describeFlip(const FlipFigures& flip) {
    return {{"hdr", flip.hdr},
            {"pixelsPerDegree", flip.pixelsPerDegree},
            {"mean", flip.mean},
            {"min", flip.min},
            {"max", flip.max},
            {"firstWeightedQuartile", flip.firstQuartile},
            {"weightedMedian", flip.weightedMedian},
            {"thirdWeightedQuartile", flip.thirdQuartile},
            {"percentiles", describePercentiles(flip.percentiles, "error")},
            {"startExposure", flip.startExposure},
            {"stopExposure", flip.stopExposure},
            {"exposures", flip.exposures},
            {"note", flip.note}};
}

Json describeLayer(const LayerComparison& layer) {
    Json result = describeFigures(layer.figures);
    result["name"] = layer.name;
    result["kind"] = kindName(layer.kind);
    result["part"] = layer.part;
    result["ssim"] = layer.ssim ? Json(*layer.ssim) : Json();
    result["msSsim"] = layer.msSsim ? Json(*layer.msSsim) : Json();
    result["flip"] = layer.flip ? describeFlip(*layer.flip) : Json();
    Json channels = Json::array(), worst = Json::array();
    for (const ChannelComparison& channel : layer.channels) {
        Json one = layer.kind == LayerKind::Ids ? Json{{"differing", channel.differing}}
                                                : describeFigures(channel.figures);
        one["name"] = channel.name;
        channels.push_back(std::move(one));
    }
    for (const WorstPixel& w : layer.worst)
        worst.push_back({{"channel", w.channel}, {"x", w.x}, {"y", w.y}, {"a", w.a}, {"b", w.b}});
    result["channels"] = std::move(channels);
    result["worst"] = std::move(worst);
    return result;
}

Json describeNoise(const NoiseTest& noise) {
    Json regions = Json::array();
    for (const NoiseTest::Region& region : noise.significantRegions)
        regions.push_back({{"channel", region.channel},
                           {"box", boxOf(region.box)},
                           {"bias", region.bias},
                           {"relativeBias", region.relativeBias},
                           {"probability", region.probability}});
    Json outlier;
    if (noise.outlier)
        outlier = {{"x", noise.outlier->x},
                   {"y", noise.outlier->y},
                   {"difference", noise.outlier->difference},
                   {"usual", noise.outlier->usual}};
    return {{"source", noise.source},
            {"level", noise.level},
            {"pixels", noise.pixels},
            {"significantPixels", noise.significantPixels},
            {"largestZ", noise.largestZ},
            {"regions", noise.regions},
            {"significantRegionCount", noise.significantRegionCount},
            {"significantRegions", regions},
            {"tooSmall", noise.tooSmall},
            {"untested", noise.untested},
            {"outlier", outlier},
            {"passed", noise.passed()}};
}

Json describePlaces(const std::vector<NonFinitePlace>& places) {
    const auto textOf = [](double value) { // JSON has no such numbers
        return std::isfinite(value) ? Json(value) : Json(fmt::format("{}", value));
    };
    Json result = Json::array();
    for (const NonFinitePlace& place : places)
        result.push_back({{"channel", place.channel},
                          {"x", place.x},
                          {"y", place.y},
                          {"a", textOf(place.a)},
                          {"b", textOf(place.b)}});
    return result;
}

void addFindings(const Comparison& comparison, Json& report) {
    Json findings = Json::array(), checks = Json::array();
    for (const Finding& finding : comparison.findings)
        findings.push_back(
            {{"kind", traitsOf(finding.kind).name}, {"text", finding.text}, {"fails", finding.fails}});
    for (const LimitCheck& check : comparison.checks)
        checks.push_back({{"where", check.where},
                          {"metric", metricName(check.limit)},
                          {"value", check.value},
                          {"limit", check.limit.value},
                          {"atLeast", traitsOf(check.limit.metric).isAtLeast},
                          {"passed", check.passed}});
    report["findings"] = std::move(findings);
    report["checks"] = std::move(checks);
}

} // namespace

Json jsonReport(const PairResult& result) {
    const auto fileOf = [](const std::string& name) {
        return Json{{"file", name.empty() ? Json() : Json(name)}};
    };
    if (!result.pair)
        return {{"a", fileOf(result.nameA)},
                {"b", fileOf(result.nameB)},
                {"exitCode", result.exitCode},
                {"verdict", verdictName(result.verdict())},
                {"problem", result.problem}};
    const Comparison& comparison = result.comparison;
    Json report{{"a", describePicture(result.nameA, result.pair->a, comparison.nonFiniteA)},
                {"b", describePicture(result.nameB, result.pair->b, comparison.nonFiniteB)},
                {"exitCode", result.exitCode},
                {"verdict", verdictName(result.verdict())},
                {"box", boxOf(comparison.box)},
                {"ignoredPixels", comparison.ignored},
                {"nonFiniteDiffering", comparison.nonFiniteDiffering},
                {"nonFinitePlaces", describePlaces(comparison.nonFinitePlaces)},
                {"notes", comparison.notes},
                {"alignment", nullptr},
                {"noise", nullptr},
                {"layers", Json::array()}};
    addFindings(comparison, report);
    for (const LayerComparison& layer : comparison.layers) report["layers"].push_back(describeLayer(layer));
    if (const auto& alignment = comparison.alignment)
        report["alignment"] = {{"dx", alignment->dx},
                               {"dy", alignment->dy},
                               {"rmse", alignment->rmse},
                               {"rmseInPlace", alignment->rmseInPlace}};
    if (comparison.noise) report["noise"] = describeNoise(*comparison.noise);
    return report;
}

Json jsonFile(Json pairs, const Totals& totals) {
    return {{"schemaVersion", 2},
            {"verdict", verdictName(totals.verdict())},
            {"failing", totals.failing},
            {"unreadable", totals.unreadable},
            {"pairs", std::move(pairs)}};
}

} // namespace rt
