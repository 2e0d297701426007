#include "tools/rt-compare/metrics.h"

#include "tools/rt-compare/error_sums.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

using PixelError = std::pair<double, std::size_t>; // |a - b| and index of the pixel

struct BlockResult {
    std::vector<ErrorSums> sums;                  // of each channel
    std::vector<std::vector<std::uint64_t>> over; // of each channel, then of the pixels: of each threshold
    std::vector<PixelError> worst;                // of the pixels that are finite
};

std::vector<std::uint64_t> countOver(const double* errors, std::size_t count,
                                     const std::vector<double>& thresholds) {
    std::vector<std::uint64_t> over;
    for (const double threshold : thresholds)
        over.push_back(static_cast<std::uint64_t>(
            std::count_if(errors, errors + count, [&](double e) { return e > threshold; })));
    return over;
}

// Keeps the largest `limit` errors, largest first; of equal ones those that came first.
void keepWorst(std::vector<PixelError>& worst, std::size_t limit, const PixelError& found) {
    if (worst.size() >= limit && (limit == 0 || found.first <= worst.back().first)) return;
    const auto isLarger = [](const PixelError& one, const PixelError& other) {
        return one.first > other.first;
    };
    worst.insert(std::ranges::upper_bound(worst, found, isLarger), found);
    if (worst.size() > limit) worst.pop_back();
}

WorstPixel pixelAt(const std::string& channel, const PixelBox& box, std::size_t i, double a, double b) {
    return {channel, box.x0 + static_cast<std::int32_t>(i % box.width()),
            box.y0 + static_cast<std::int32_t>(i / box.width()), a, b};
}

ErrorFigures figuresOf(const ErrorSums& sums, double peak) {
    ErrorFigures figures;
    figures.values = sums.values;
    figures.compared = sums.compared;
    figures.a = sums.a.range();
    figures.b = sums.b.range();
    if (sums.compared == 0) return figures;
    const auto count = static_cast<double>(sums.compared);
    figures.maxAbs = sums.maxAbs;
    figures.bias = sums.difference / count;
    figures.mae = sums.absolute / count;
    figures.mse = sums.square / count;
    figures.rmse = std::sqrt(figures.mse);
    figures.relMse = sums.relative / count;
    figures.smape = sums.symmetric / count;
    figures.psnr = 10.0 * std::log10(peak * peak / figures.mse);
    return figures;
}

// Rounded to single precision, a percentile may come out above the largest error of all.
void limitPercentiles(ErrorFigures& figures) {
    for (Percentile& percentile : figures.percentiles)
        percentile.absError = std::min(percentile.absError, figures.maxAbs);
}

class LayerMeasurement {
public:
    LayerMeasurement(const LayerPair& layer, const ComparedRegion& focus, const MetricOptions& options)
        : layer_(layer), focus_(focus), options_(options), pixelCount_(focus.box.pixelCount()),
          blocks_((pixelCount_ + kBlockPixels - 1) / kBlockPixels) {}

    LayerComparison run() {
        tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t block) { measure(block); });
        LayerComparison result;
        addUp(result);
        addDistributions(result);
        addWorst(result);
        return result;
    }

private:
    void measure(std::size_t block) {
        const std::size_t first = block * kBlockPixels, count = std::min(kBlockPixels, pixelCount_ - first);
        const std::uint8_t* ignored = focus_.ignored.empty() ? nullptr : focus_.ignored.data() + first;
        std::vector<ErrorCounts>& counts = counts_.local();
        counts.resize(layer_.channels.size());
        BlockResult& result = blocks_[block];
        std::array<double, kBlockPixels> errors, pixelErrors;
        pixelErrors.fill(kIgnored);
        for (std::size_t c = 0; c < layer_.channels.size(); ++c) {
            const ChannelPair& channel = layer_.channels[c];
            measureBlock(channel.a->values.data() + first, channel.b->values.data() + first, ignored, count,
                         errors.data(), result.sums.emplace_back(), counts[c]);
            result.over.push_back(countOver(errors.data(), count, options_.thresholds));
            for (std::size_t i = 0; i < count; ++i) pixelErrors[i] = std::max(pixelErrors[i], errors[i]);
        }
        result.over.push_back(countOver(pixelErrors.data(), count, options_.thresholds));
        for (std::size_t i = 0; i < count; ++i)
            if (pixelErrors[i] > 0.0 && std::isfinite(pixelErrors[i]))
                keepWorst(result.worst, options_.worst, {pixelErrors[i], first + i});
    }

    std::vector<OverThreshold> overOf(std::size_t set) const {
        std::vector<OverThreshold> result;
        const auto pixels = static_cast<double>(pixelCount_ - focus_.ignoredCount);
        for (std::size_t t = 0; t < options_.thresholds.size(); ++t) {
            OverThreshold& over = result.emplace_back();
            over.threshold = options_.thresholds[t];
            for (const BlockResult& block : blocks_) over.pixels += block.over[set][t];
            over.fraction = pixels > 0.0 ? static_cast<double>(over.pixels) / pixels : kNotComputed;
        }
        return result;
    }

    void addUp(LayerComparison& result) const {
        ErrorSums all;
        for (std::size_t c = 0; c < layer_.channels.size(); ++c) {
            ErrorSums sums;
            for (const BlockResult& block : blocks_)
                sums.add(block.sums[c]); // in order: the same on any machine
            all.add(sums);
            ErrorFigures figures = figuresOf(sums, options_.peak);
            figures.over = overOf(c);
            result.channels.push_back({layer_.channels[c].name, std::move(figures), 0});
        }
        result.figures = figuresOf(all, options_.peak);
        result.figures.over = overOf(layer_.channels.size());
    }

    void addDistributions(LayerComparison& result) {
        std::vector<ErrorCounts> counts(layer_.channels.size());
        for (const std::vector<ErrorCounts>& ofThread : counts_)
            for (std::size_t c = 0; c < counts.size(); ++c) counts[c].add(ofThread[c]);
        auto percentiles = findPercentiles(layer_, focus_, counts, options_.percents);
        ErrorCounts all;
        for (std::size_t c = 0; c < counts.size(); ++c) {
            result.channels[c].figures.percentiles = std::move(percentiles[c]);
            result.channels[c].figures.histogram = histogramOf(counts[c]);
            all.add(counts[c]);
        }
        result.figures.percentiles = std::move(percentiles.back());
        result.figures.histogram = histogramOf(all);
        limitPercentiles(result.figures);
        for (ChannelComparison& channel : result.channels) limitPercentiles(channel.figures);
    }

    void addWorst(LayerComparison& result) const {
        std::vector<PixelError> worst;
        for (const BlockResult& block : blocks_)
            for (const PixelError& found : block.worst) keepWorst(worst, options_.worst, found);
        for (const PixelError& found : worst) {
            const auto errorOf = [&](const ChannelPair& channel) {
                return std::abs(double(channel.a->values[found.second]) -
                                double(channel.b->values[found.second]));
            };
            const ChannelPair& channel = *std::ranges::max_element(layer_.channels, {}, errorOf);
            result.worst.push_back(pixelAt(channel.name, focus_.box, found.second,
                                           channel.a->values[found.second], channel.b->values[found.second]));
        }
    }

    const LayerPair& layer_;
    const ComparedRegion& focus_;
    const MetricOptions& options_;
    std::size_t pixelCount_;
    std::vector<BlockResult> blocks_;
    tbb::enumerable_thread_specific<std::vector<ErrorCounts>> counts_;
};

LayerComparison measureIds(const LayerPair& layer, const ComparedRegion& focus,
                           const MetricOptions& options) {
    LayerComparison result;
    const ChannelPair& channel = layer.channels.front();
    std::uint64_t differing = 0;
    for (std::size_t i = 0; i < channel.a->uints.size(); ++i) {
        const std::uint32_t a = channel.a->uints[i], b = channel.b->uints[i];
        if (a == b) continue; // what is ignored is 0 in both
        ++differing;
        if (result.worst.size() < options.worst)
            result.worst.push_back(pixelAt(channel.name, focus.box, i, a, b));
    }
    const std::uint64_t pixels = focus.box.pixelCount() - focus.ignoredCount;
    result.figures.values = result.figures.compared = pixels;
    const double fraction = static_cast<double>(differing) / static_cast<double>(pixels);
    result.figures.over.push_back({0.0, differing, pixels ? fraction : kNotComputed});
    result.channels.push_back({channel.name, result.figures, differing});
    return result;
}

} // namespace

LayerComparison measureLayer(const LayerPair& layer, const ComparedRegion& focus,
                             const MetricOptions& options) {
    LayerComparison result = layer.kind == LayerKind::Ids ? measureIds(layer, focus, options)
                                                          : LayerMeasurement(layer, focus, options).run();
    result.part = layer.part;
    result.name = layer.name;
    result.kind = layer.kind;
    return result;
}

} // namespace rt
