#include "tools/rt-compare/report.h"

#include <fmt/format.h>

namespace rt {
namespace {

std::string describePicture(const char* which, const std::string& file, const Picture& picture,
                            const NonFiniteCounts& nonFinite) {
    std::string text = fmt::format("{}: {}: {}", which, file, picture.format);
    for (const PicturePart& part : picture.parts) {
        text += picture.parts.size() > 1 ? fmt::format("; part {}: ", part.name) : ", ";
        text += fmt::format("{} x {} pixels, channels", part.image.width, part.image.height);
        for (const ImageChannel& channel : part.image.channels) text += " " + channel.name;
    }
    if (nonFinite.total() > 0)
        text += fmt::format("; {} non-finite pixels: {} NaN, {} +Inf, {} -Inf", nonFinite.pixels,
                            nonFinite.nan, nonFinite.positiveInf, nonFinite.negativeInf);
    return text + "\n";
}

std::string psnrText(const ErrorFigures& figures) {
    if (!(figures.psnr == figures.psnr)) return "";
    return fmt::format(", PSNR {:.6g} dB", figures.psnr);
}

std::string describeFigures(const ErrorFigures& figures) {
    return fmt::format("RMSE {:.9g}, maximum |a-b| {:.9g}, MAE {:.9g}, relMSE {:.6g}, sMAPE {:.6g}{}",
                       figures.rmse, figures.maxAbs, figures.mae, figures.relMse, figures.smape,
                       psnrText(figures));
}

std::string describeFlip(const FlipFigures& flip) {
    std::string text = fmt::format(
        "  FLIP mean {:.6f}, weighted median {:.6f} (quartiles {:.6f} and {:.6f}), maximum {:.6f}; {:.5g} pixels "
        "per degree",
        flip.mean, flip.weightedMedian, flip.firstQuartile, flip.thirdQuartile, flip.max, flip.pixelsPerDegree);
    if (flip.hdr)
        text += fmt::format("; {} exposures from {:.4f} to {:.4f} stops", flip.exposures, flip.startExposure,
                            flip.stopExposure);
    return text + (flip.note.empty() ? "\n" : "; " + flip.note + "\n");
}

std::string describeDistribution(const ErrorFigures& figures) {
    std::string text;
    for (const Percentile& p : figures.percentiles)
        text += fmt::format("{} {:g} % {:.6g}", text.empty() ? "  percentiles of |a-b|:" : ",", p.percent,
                            p.absError);
    if (!text.empty()) text += "\n";
    bool isFirst = true;
    for (const OverThreshold& over : figures.over) {
        text += fmt::format("{} {:g}: {} ({:.4g} %)", isFirst ? "  pixels that differ by more than" : ",",
                            over.threshold, over.pixels, 100.0 * over.fraction);
        isFirst = false;
    }
    return isFirst ? text : text + "\n";
}

std::string describeLayer(const LayerComparison& layer, ValueScale scale) {
    const ErrorFigures& figures = layer.figures;
    std::string text;
    if (layer.kind == LayerKind::Ids) {
        for (const ChannelComparison& channel : layer.channels)
            text += fmt::format("{}: {} of {} pixels differ\n", channel.name, channel.differing, figures.values);
    } else {
        text = fmt::format("{}: {}, {}, over {} of {} values\n", layer.name, describeFigures(figures),
                           scale == ValueScale::Linear ? "in linear units" : "in display units from 0 to 1",
                           figures.compared, figures.values);
        if (layer.ssim) text += fmt::format("  SSIM {:.7f}\n", *layer.ssim);
        if (layer.msSsim) text += fmt::format("  MS-SSIM {:.7f}\n", *layer.msSsim);
        if (layer.flip) text += describeFlip(*layer.flip);
        text += describeDistribution(figures);
        if (layer.channels.size() > 1)
            for (const ChannelComparison& channel : layer.channels)
                text += fmt::format("  {}: {}\n", channel.name, describeFigures(channel.figures));
    }
    for (const WorstPixel& worst : layer.worst)
        text += fmt::format("  worst: {} at x {}, y {}: a {:.9g}, b {:.9g}\n", worst.channel, worst.x, worst.y,
                            worst.a, worst.b);
    return text;
}

std::string describeNoise(const NoiseTest& noise) {
    return fmt::format("noise ({}): {} of {} pixels and {} of {} regions differ by more than it, with false alarms "
                       "at {:g}; largest difference {:.3g} standard deviations\n",
                       noise.source, noise.significantPixels, noise.pixels, noise.significantRegionCount,
                       noise.regions, noise.level, noise.largestZ);
}

std::string painted(const std::string& line, const char* color, bool colored) {
    return colored ? fmt::format("\x1b[{}m{}\x1b[0m\n", color, line) : line + "\n";
}

} // namespace

std::string textReport(const ReportedPair& reported, bool colored) {
    const Comparison& comparison = reported.comparison;
    std::string text = describePicture("a", reported.nameA, reported.pair.a, comparison.nonFiniteA) +
                       describePicture("b", reported.nameB, reported.pair.b, comparison.nonFiniteB);
    if (comparison.ignored > 0) text += fmt::format("{} pixels are masked and ignored\n", comparison.ignored);
    for (const LayerComparison& layer : comparison.layers) text += describeLayer(layer, comparison.scale);
    if (const auto& alignment = comparison.alignment; alignment && alignment->shifted())
        text += fmt::format("alignment: b shifted by x {}, y {} pixels fits better: RMSE {:.6g} instead of {:.6g}\n",
                            alignment->dx, alignment->dy, alignment->rmse, alignment->rmseInPlace);
    if (comparison.noise) text += describeNoise(*comparison.noise);
    for (const LimitCheck& check : comparison.checks)
        text += fmt::format("limit: {} of {} is {:.9g}, {} {:.9g}: {}\n", check.metric, check.where, check.value,
                            check.atLeast ? "at least" : "at most", check.limit,
                            check.passed ? "kept" : "exceeded");
    for (const std::string& note : comparison.notes) text += "note: " + note + "\n";
    for (const Finding& finding : comparison.findings)
        text += finding.fails ? painted("fails: " + finding.text, "31", colored) : "allowed: " + finding.text + "\n";
    const bool isPassed = comparison.passed();
    return text + painted(isPassed ? "verdict: pass" : "verdict: fail", isPassed ? "1;32" : "1;31", colored);
}

} // namespace rt
