#include "tools/rt-compare/json_report.h"

#include <nlohmann/json.hpp>

namespace rt {
namespace {

nlohmann::json describePicture(const Picture& picture, const NonFiniteCounts& counts) {
    nlohmann::json channels = nlohmann::json::array();
    for (const ImageChannel& channel : picture.parts.front().image.channels) channels.push_back(channel.name);
    const PixelBox& size = picture.parts.front().displayWindow;
    nlohmann::json result{{"file", picture.name},
                          {"width", size.width()},
                          {"height", size.height()},
                          {"channels", channels},
                          {"nonFinitePixels", counts.pixels},
                          {"nan", counts.nan},
                          {"positiveInf", counts.positiveInf},
                          {"negativeInf", counts.negativeInf},
                          {"firstNonFinite", nullptr}};
    if (const auto& first = counts.first)
        result["firstNonFinite"] = {{"channel", first->channel}, {"x", first->x}, {"y", first->y}};
    return result;
}

nlohmann::json describeFigures(const ErrorFigures& figures) {
    return {{"values", figures.values},
            {"compared", figures.compared},
            {"rmse", figures.rmse},
            {"maxAbs", figures.maxAbs}};
}

} // namespace

nlohmann::json jsonReport(const PairResult& result, const PreparedPair* pair) {
    if (!result.comparison)
        return {
            {"a", result.nameA}, {"b", result.nameB}, {"verdict", "none"}, {"failures", {result.problem}}};
    const Comparison& comparison = *result.comparison;
    nlohmann::json failures = nlohmann::json::array(), channels = nlohmann::json::object(),
                   uints = nlohmann::json::object();
    for (const Finding& finding : comparison.findings)
        if (finding.fails) failures.push_back(finding.text);
    for (const LayerComparison& layer : comparison.layers)
        for (const ChannelComparison& channel : layer.channels)
            if (layer.kind == LayerKind::Ids)
                uints[channel.name] = {{"values", channel.figures.values}, {"differing", channel.differing}};
            else
                channels[channel.name] = describeFigures(channel.figures);
    nlohmann::json report{{"schemaVersion", 1},
                          {"verdict", comparison.passed() ? "pass" : "fail"},
                          {"failures", failures},
                          {"a", describePicture(pair->a, comparison.nonFiniteA)},
                          {"b", describePicture(pair->b, comparison.nonFiniteB)},
                          {"color", nullptr},
                          {"worst", nullptr},
                          {"channels", channels},
                          {"uints", uints}};
    if (const LayerComparison* color = comparison.color()) {
        report["color"] = describeFigures(color->figures);
        if (!color->worst.empty()) {
            const WorstPixel& worst = color->worst.front();
            report["worst"] = {
                {"channel", worst.channel}, {"x", worst.x}, {"y", worst.y}, {"a", worst.a}, {"b", worst.b}};
        }
    }
    return report;
}

} // namespace rt
