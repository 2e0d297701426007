#include "tools/rt-compare/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

std::string describeImage(const char* which, const std::string& file, const Image& image,
                          const NonFiniteCounts& nonFinite) {
    std::string channels;
    for (const ImageChannel& channel : image.channels) channels += " " + channel.name;
    return fmt::format("{}: {}: {} x {} pixels, channels{}; {} non-finite pixels: {} NaN, {} +Inf, {} -Inf\n",
                       which, file, image.width, image.height, channels, nonFinite.pixels, nonFinite.nan,
                       nonFinite.positiveInf, nonFinite.negativeInf);
}

nlohmann::json describeImage(const std::string& file, const Image& image, const NonFiniteCounts& nonFinite) {
    nlohmann::json channels = nlohmann::json::array();
    for (const ImageChannel& channel : image.channels) channels.push_back(channel.name);
    nlohmann::json result{{"file", file},
                          {"width", image.width},
                          {"height", image.height},
                          {"channels", channels},
                          {"nonFinitePixels", nonFinite.pixels},
                          {"nan", nonFinite.nan},
                          {"positiveInf", nonFinite.positiveInf},
                          {"negativeInf", nonFinite.negativeInf},
                          {"firstNonFinite", nullptr}};
    if (const auto& first = nonFinite.first)
        result["firstNonFinite"] = {{"channel", first->channel}, {"x", first->x}, {"y", first->y}};
    return result;
}

nlohmann::json describeSums(const ErrorSums& sums) {
    nlohmann::json result{
        {"values", sums.values}, {"compared", sums.compared}, {"rmse", nullptr}, {"maxAbs", nullptr}};
    if (sums.compared > 0) {
        result["rmse"] = sums.rmse();
        result["maxAbs"] = sums.maxAbs;
    }
    return result;
}

} // namespace

std::string textReport(const ComparedFiles& files, const Comparison& comparison) {
    std::string text = describeImage("a", files.nameA, files.a, comparison.nonFiniteA) +
                       describeImage("b", files.nameB, files.b, comparison.nonFiniteB);
    if (const auto& color = comparison.color)
        text += fmt::format(
            "RMSE {:.9g} (limit {:.9g}), maximum |a-b| {:.9g}, in linear units over {} of {} color values\n",
            color->rmse(), files.maxRmse, color->maxAbs, color->compared, color->values);
    for (const ChannelErrors& channel : comparison.channels)
        text +=
            fmt::format("  {}: RMSE {:.9g}, maximum |a-b| {:.9g}, {} of {} values\n", channel.name,
                        channel.sums.rmse(), channel.sums.maxAbs, channel.sums.compared, channel.sums.values);
    for (const UintDifference& difference : comparison.uints)
        text += fmt::format("  {}: {} of {} pixels differ\n", difference.name, difference.pixels,
                            files.a.pixelCount());
    if (const auto& worst = comparison.worst)
        text += fmt::format("worst: {} at x {}, y {}: a {:.9g}, b {:.9g}\n", worst->channel, worst->x,
                            worst->y, worst->a, worst->b);
    if (comparison.passed()) return text + "verdict: pass\n";
    for (const std::string& failure : comparison.failures) text += "fails: " + failure + "\n";
    return text + "verdict: fail\n";
}

nlohmann::json jsonReport(const ComparedFiles& files, const Comparison& comparison) {
    nlohmann::json channels = nlohmann::json::object(), uints = nlohmann::json::object();
    for (const ChannelErrors& channel : comparison.channels)
        channels[channel.name] = describeSums(channel.sums);
    for (const UintDifference& difference : comparison.uints)
        uints[difference.name] = {{"values", files.a.pixelCount()}, {"differing", difference.pixels}};
    nlohmann::json report{{"schemaVersion", 1},
                          {"verdict", comparison.passed() ? "pass" : "fail"},
                          {"failures", comparison.failures},
                          {"maxRmse", files.maxRmse},
                          {"a", describeImage(files.nameA, files.a, comparison.nonFiniteA)},
                          {"b", describeImage(files.nameB, files.b, comparison.nonFiniteB)},
                          {"color", nullptr},
                          {"worst", nullptr},
                          {"channels", channels},
                          {"uints", uints}};
    if (comparison.color) report["color"] = describeSums(*comparison.color);
    if (const auto& worst = comparison.worst)
        report["worst"] = {
            {"channel", worst->channel}, {"x", worst->x}, {"y", worst->y}, {"a", worst->a}, {"b", worst->b}};
    return report;
}

} // namespace rt
