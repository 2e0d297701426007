#include "tools/rt-compare/text_report.h"

#include "tools/rt-compare/limits.h"

#include <fmt/format.h>

#include <cmath>

namespace rt {
namespace {

std::string number(double value) {
    return std::isnan(value) ? "not computed" : fmt::format("{:.9g}", value);
}

// Names come from files: no control character of theirs reaches the terminal or makes a line of its own.
std::string printable(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        result += byte < 0x20 || byte == 0x7f ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
    }
    return result;
}

std::string describePart(const PicturePart& part, bool isNamed) {
    const Image& image = part.image;
    std::string text = isNamed ? fmt::format("; part {}:", printable(part.name)) : "";
    text += fmt::format(" {} x {} pixels, channels", part.displayWindow.width(), part.displayWindow.height());
    for (const ImageChannel& channel : image.channels) text += fmt::format(" {}", printable(channel.name));
    return text;
}

std::string describePicture(const char* which, const Picture& picture, const NonFiniteCounts& counts) {
    std::string text = fmt::format("{}: {}:", which, printable(picture.name));
    for (const PicturePart& part : picture.parts) text += describePart(part, picture.parts.size() > 1);
    return text + fmt::format("; {}; {} non-finite pixels: {} NaN, {} +Inf, {} -Inf\n", picture.format,
                              counts.pixels, counts.nan, counts.positiveInf, counts.negativeInf);
}

std::string describeRegions(const Comparison& comparison, const PreparedPair& pair) {
    const char* units =
        comparison.scale == ValueScale::Linear ? "linear light" : "display values from 0 to 1";
    std::string text = fmt::format("compared: {}", units);
    if (pair.regions.size() == 1)
        text += fmt::format(", pixels {},{} up to {},{}", comparison.box.x0, comparison.box.y0,
                            comparison.box.x1, comparison.box.y1);
    if (comparison.ignored > 0) text += fmt::format(", without {} ignored pixels", comparison.ignored);
    return text + "\n";
}

std::string describeIds(const LayerComparison& layer) {
    return fmt::format("{}: {} of {} pixels differ\n", printable(layer.name),
                       layer.channels.front().differing, layer.figures.values);
}

std::string describeWorst(const LayerComparison& layer) {
    std::string text;
    for (const WorstPixel& worst : layer.worst)
        text += fmt::format("  worst: {} at x {}, y {}: a {:.9g}, b {:.9g}\n", printable(worst.channel),
                            worst.x, worst.y, worst.a, worst.b);
    return text;
}

std::string describeNumbers(const LayerComparison& layer) {
    const ErrorFigures& f = layer.figures;
    std::string text =
        fmt::format("{}: RMSE {}, maximum |a-b| {}, mean |a-b| {}, mean a-b {}, over {} of {} values\n",
                    printable(layer.name), number(f.rmse), number(f.maxAbs), number(f.mae), number(f.bias),
                    f.compared, f.values);
    text += fmt::format("  MSE {}, relMSE {}, SMAPE {}, PSNR {} dB", number(f.mse), number(f.relMse),
                        number(f.smape), number(f.psnr));
    if (layer.ssim) text += fmt::format(", SSIM {:.6f}", *layer.ssim);
    if (layer.msSsim) text += fmt::format(", MS-SSIM {:.6f}", *layer.msSsim);
    text += "\n";
    if (f.maxAbs == 0.0) return text;
    text += "  |a-b| at most";
    for (const Percentile& p : f.percentiles)
        text += fmt::format(" {:.6g} in {:g} %,", p.absError, p.percent);
    text.back() = '\n';
    text += "  pixels that differ";
    for (const OverThreshold& over : f.over)
        text += over.threshold == 0.0 ? fmt::format(": {} ({:.4g} %)", over.pixels, 100.0 * over.fraction)
                                      : fmt::format(", by more than {:g}: {} ({:.4g} %)", over.threshold,
                                                    over.pixels, 100.0 * over.fraction);
    text += "\n";
    if (layer.channels.size() > 1)
        for (const ChannelComparison& channel : layer.channels)
            text += fmt::format("  {}: RMSE {}, maximum |a-b| {}, {} of {} values\n", printable(channel.name),
                                number(channel.figures.rmse), number(channel.figures.maxAbs),
                                channel.figures.compared, channel.figures.values);
    return text;
}

std::string describeFlip(const FlipFigures& flip) {
    std::string text = fmt::format("  FLIP ({}): mean {:.6f}, weighted median {:.6f}, weighted quartiles "
                                   "{:.6f} and {:.6f}, maximum {:.6f}, at "
                                   "{:.4g} pixels per degree",
                                   flip.hdr ? "HDR" : "LDR", flip.mean, flip.weightedMedian,
                                   flip.firstQuartile, flip.thirdQuartile, flip.max, flip.pixelsPerDegree);
    if (flip.hdr)
        text += fmt::format(", {} exposures from {:.4g} to {:.4g} stops", flip.exposures, flip.startExposure,
                            flip.stopExposure);
    if (!flip.note.empty()) text += fmt::format(" ({})", printable(flip.note));
    text += "\n  FLIP at most";
    for (const Percentile& p : flip.percentiles)
        text += fmt::format(" {:.6g} in {:g} %,", p.absError, p.percent);
    text.back() = '\n';
    return text;
}

std::string describeLayer(const LayerComparison& layer) {
    std::string text = layer.kind == LayerKind::Ids ? describeIds(layer) : describeNumbers(layer);
    if (layer.flip) text += describeFlip(*layer.flip);
    return text + describeWorst(layer);
}

std::string describeNoise(const NoiseTest& noise) {
    return fmt::format(
        "noise ({}): {} of {} pixels and {} of {} regions are beyond it, at a false alarm rate of {:g}\n",
        printable(noise.source), noise.significantPixels, noise.pixels, noise.significantRegionCount,
        noise.regions, noise.level);
}

std::string describeAlignment(const Alignment& found) {
    if (!found.shifted()) return "alignment: no shift makes the images much more alike\n";
    return fmt::format("alignment: a at x, y is most like b at x{:+}, y{:+}: RMSE {:.6g} instead of {:.6g}\n",
                       found.dx, found.dy, found.rmse, found.rmseInPlace);
}

// A line, in a terminal's color.
std::string painted(const std::string& line, const char* color, bool colored) {
    return colored ? fmt::format("\x1b[{}m{}\x1b[0m\n", color, line) : line + "\n";
}

std::string verdictLine(Verdict verdict, bool colored) {
    return painted(fmt::format("verdict: {}", verdictName(verdict)),
                   verdict == Verdict::Pass ? "1;32" : "1;31", colored);
}

// Of a pair that was not compared.
std::string describeProblem(const PairResult& result, bool colored) {
    if (result.verdict() != Verdict::Pass)
        return painted("fails: " + printable(result.problem), "31", colored);
    return fmt::format("allowed: {}: {}\n", traitsOf(FindingKind::Files).name, printable(result.problem));
}

std::string describeFindings(const Comparison& comparison, bool colored) {
    std::string text;
    for (const Finding& finding : comparison.findings)
        if (!finding.fails)
            text += fmt::format("allowed: {}: {}\n", traitsOf(finding.kind).name, printable(finding.text));
    for (const std::string& note : comparison.notes) text += fmt::format("note: {}\n", printable(note));
    for (const Finding& finding : comparison.findings)
        if (finding.fails)
            text +=
                painted(fmt::format("fails: {}: {}", traitsOf(finding.kind).name, printable(finding.text)),
                        "31", colored);
    return text;
}

} // namespace

std::string textReport(const PairResult& result, bool colored) {
    if (!result.pair) return describeProblem(result, colored) + verdictLine(result.verdict(), colored);
    const Comparison& comparison = result.comparison;
    std::string text = describePicture("a", result.pair->a, comparison.nonFiniteA) +
                       describePicture("b", result.pair->b, comparison.nonFiniteB);
    if (!comparison.layers.empty()) text += describeRegions(comparison, *result.pair);
    for (const LayerComparison& layer : comparison.layers) text += describeLayer(layer);
    for (const NonFinitePlace& place : comparison.nonFinitePlaces)
        text += fmt::format("not finite: {} at x {}, y {}: a {}, b {}\n", printable(place.channel), place.x,
                            place.y, place.a, place.b);
    if (comparison.alignment) text += describeAlignment(*comparison.alignment);
    if (comparison.noise) text += describeNoise(*comparison.noise);
    for (const LimitCheck& check : comparison.checks)
        text += fmt::format("limit: {}: {} {} (limit {}{:.9g}): {}\n", printable(check.where),
                            metricName(check.limit), number(check.value),
                            traitsOf(check.limit.metric).isAtLeast ? "at least " : "", check.limit.value,
                            check.passed ? "kept" : "broken");
    return text + describeFindings(comparison, colored) + verdictLine(result.verdict(), colored);
}

std::string textSummary(const Totals& totals) {
    return fmt::format("{} pairs: {} pass, {} differ, {} without a verdict\n", totals.pairs,
                       totals.pairs - totals.failing - totals.unreadable, totals.failing, totals.unreadable);
}

} // namespace rt
