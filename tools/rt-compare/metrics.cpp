#include "tools/rt-compare/metrics.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/error_counts.h"
#include "tools/rt-compare/float_lanes.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rt {
namespace {

constexpr std::size_t kBlock = 2048; // pixels; their errors stay in the cache
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kIgnored = -1.0; // in arrays of errors

using PixelError = std::pair<double, std::size_t>; // |a - b| and index of the pixel

struct RangeSums {
    double min = kInfinity, max = -kInfinity, sum = 0.0;
    std::uint64_t finite = 0;

    void add(const RangeSums& other) {
        min = std::min(min, other.min);
        max = std::max(max, other.max);
        sum += other.sum;
        finite += other.finite;
    }
    ValueRange range() const {
        if (finite == 0) return {};
        return {min, max, sum / static_cast<double>(finite)};
    }
};

struct Sums {
    std::uint64_t values = 0, compared = 0;
    double difference = 0.0, absolute = 0.0, square = 0.0, relative = 0.0, symmetric = 0.0, maxAbs = 0.0;
    RangeSums a, b;

    void add(const Sums& other) {
        values += other.values;
        compared += other.compared;
        difference += other.difference;
        absolute += other.absolute;
        square += other.square;
        relative += other.relative;
        symmetric += other.symmetric;
        maxAbs = std::max(maxAbs, other.maxAbs);
        a.add(other.a);
        b.add(other.b);
    }
};

struct BlockResult {
    std::vector<Sums> sums;                       // of each channel
    std::vector<std::vector<std::uint64_t>> over; // of each channel, then of the pixels: of each threshold
    std::vector<PixelError> worst;                // of the pixels that are finite
};

// Of values that are finite.
RT_WIDE_LANES void addRange(std::span<const float> values, RangeSums& range) {
    if (values.empty()) return;
    Floats least = allFloats(values[0]), most = least;
    Doubles sums[2] = {};
    const std::size_t whole = values.size() / kLanes * kLanes;
    for (std::size_t i = 0; i < whole; i += kLanes) {
        const float* const from = values.data() + i;
        least = lesser(loadFloats(from), least);
        most = greater(loadFloats(from), most);
        sums[0] += loadDoubles(from);
        sums[1] += loadDoubles(from + kDoubleLanes);
    }
    RangeSums found{values[0], values[0], sumOf(sums[0] + sums[1]), values.size()};
    const auto include = [&found](float value) {
        found.min = std::min<double>(found.min, value);
        found.max = std::max<double>(found.max, value);
    };
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        include(least[lane]);
        include(most[lane]);
    }
    for (std::size_t i = whole; i < values.size(); ++i) {
        include(values[i]);
        found.sum += values[i];
    }
    range.add(found);
}

struct LaneSums {
    Doubles difference{}, absolute{}, square{}, relative{}, symmetric{}, maxAbs{};

    // Doubles hold the difference of finite floats. Equal values add nothing.
    Doubles add(const Doubles& va, const Doubles& vb) {
        constexpr double kEpsilon = 1e-2;
        const Doubles d = va - vb, size = d < 0.0 ? -d : d;
        const Doubles sizeA = va < 0.0 ? -va : va, sizeB = vb < 0.0 ? -vb : vb;
        difference += d;
        absolute += size;
        square += d * d;
        relative += d * d / (vb * vb + kEpsilon);
        symmetric += size / (sizeA + sizeB + kEpsilon);
        maxAbs = size > maxAbs ? size : maxAbs;
        return size;
    }
};

// Adds values that are finite; errors[i] becomes |a - b|.
RT_WIDE_LANES void addErrors(std::span<const float> a, std::span<const float> b, double* errors, Sums& sums) {
    LaneSums lanes;
    const std::size_t whole = a.size() / kDoubleLanes * kDoubleLanes, rest = a.size() - whole;
    for (std::size_t i = 0; i < whole; i += kDoubleLanes) {
        const Doubles found = lanes.add(loadDoubles(a.data() + i), loadDoubles(b.data() + i));
        std::memcpy(errors + i, &found, sizeof found);
    }
    float restA[kDoubleLanes] = {}, restB[kDoubleLanes] = {};
    std::copy_n(a.data() + whole, rest, restA);
    std::copy_n(b.data() + whole, rest, restB);
    const Doubles found = lanes.add(loadDoubles(restA), loadDoubles(restB));
    std::memcpy(errors + whole, &found, rest * sizeof(double));
    sums.compared += a.size();
    sums.difference += sumOf(lanes.difference);
    sums.absolute += sumOf(lanes.absolute);
    sums.square += sumOf(lanes.square);
    sums.relative += sumOf(lanes.relative);
    sums.symmetric += sumOf(lanes.symmetric);
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane)
        sums.maxAbs = std::max(sums.maxAbs, lanes.maxAbs[lane]);
}

// Of a block some of whose values are ignored or not finite: the others, close together.
struct Sieve {
    std::vector<float> a, b;         // finite in both
    std::vector<std::size_t> places; // of these
    std::vector<float> finiteA, finiteB;
    std::uint64_t values = 0;

    // errors[i] becomes kIgnored, or what a difference that is not finite counts as.
    Sieve(const float* fromA, const float* fromB, const std::uint8_t* ignored, std::size_t count,
          double* errors) {
        for (std::size_t i = 0; i < count; ++i) {
            errors[i] = kIgnored;
            if (ignored && ignored[i]) continue;
            ++values;
            const float va = fromA[i], vb = fromB[i];
            if (std::isfinite(va)) finiteA.push_back(va);
            if (std::isfinite(vb)) finiteB.push_back(vb);
            if (!std::isfinite(va) || !std::isfinite(vb)) {
                errors[i] = va == vb || (std::isnan(va) && std::isnan(vb)) ? 0.0 : kInfinity;
                continue;
            }
            a.push_back(va);
            b.push_back(vb);
            places.push_back(i);
        }
    }
};

// Adds the values of one channel's block; errors[i] becomes |a - b|, infinite where that is not finite.
void measureBlock(const float* a, const float* b, const std::uint8_t* ignored, std::size_t count,
                  double* errors, Sums& sums, ErrorCounts& counts) {
    std::array<std::uint32_t, kBlock> bits;
    findErrorBits(a, b, ignored, count, bits.data());
    counts.add({bits.data(), count});
    if (*std::max_element(bits.begin(), bits.begin() + count) < kNoError) {
        addErrors({a, count}, {b, count}, errors, sums);
        addRange({a, count}, sums.a);
        addRange({b, count}, sums.b);
        sums.values += count;
        return;
    }
    const Sieve sieve(a, b, ignored, count, errors);
    std::array<double, kBlock> found;
    addErrors(sieve.a, sieve.b, found.data(), sums);
    for (std::size_t i = 0; i < sieve.places.size(); ++i) errors[sieve.places[i]] = found[i];
    addRange(sieve.finiteA, sums.a);
    addRange(sieve.finiteB, sums.b);
    sums.values += sieve.values;
}

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

ErrorFigures figuresOf(const Sums& sums, double peak) {
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
          blocks_((pixelCount_ + kBlock - 1) / kBlock) {}

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
        const std::size_t first = block * kBlock, count = std::min(kBlock, pixelCount_ - first);
        const std::uint8_t* ignored = focus_.ignored.empty() ? nullptr : focus_.ignored.data() + first;
        std::vector<ErrorCounts>& counts = counts_.local();
        counts.resize(layer_.channels.size());
        BlockResult& result = blocks_[block];
        std::array<double, kBlock> errors, pixelErrors;
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
            if (pixelErrors[i] > 0.0 && pixelErrors[i] < kInfinity)
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
        Sums all;
        for (std::size_t c = 0; c < layer_.channels.size(); ++c) {
            Sums sums;
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
