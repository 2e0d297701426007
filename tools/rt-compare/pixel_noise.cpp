#include "tools/rt-compare/noise_stages.h"

#include "common/error.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace rt {
namespace {

using Plane = std::vector<double>;

/// So many times farther than the other renders no render is by noise: in a pixel; in all of 3x3 pixels.
constexpr double kOutlier = 30.0, kOutlierOf9 = 6.0;

/// Luminance of a color layer's side; empty if it has none.
Plane luminancePlane(const LayerPair& layer, const ImageChannel* ChannelPair::*side) {
    const auto values = [&](const char* name) -> const std::vector<float>* {
        const ChannelPair* channel = layer.find(name);
        return channel ? &(channel->*side)->values : nullptr;
    };
    if (const std::vector<float>* grey = values("Y")) return {grey->begin(), grey->end()};
    const std::vector<float>*r = values("R"), *g = values("G"), *b = values("B");
    if (!r || !g || !b) return {};
    Plane luminance(r->size());
    for (std::size_t i = 0; i < luminance.size(); ++i) luminance[i] = luminanceOf((*r)[i], (*g)[i], (*b)[i]);
    return luminance;
}

/// Means over (2 radius + 1)^2 pixels, fewer at the borders.
Plane boxMean(const Plane& values, std::size_t width, int radius) {
    const std::size_t height = values.size() / width;
    const auto alongLines = [&](const Plane& in, std::size_t lines, std::size_t length, std::size_t lineStep,
                                std::size_t step) {
        Plane out(in.size());
        for (std::size_t line = 0; line < lines; ++line) {
            for (std::size_t i = 0; i < length; ++i) {
                const std::size_t lo = i < std::size_t(radius) ? 0 : i - std::size_t(radius);
                const std::size_t hi = std::min(length - 1, i + std::size_t(radius));
                double sum = 0.0;
                for (std::size_t k = lo; k <= hi; ++k) sum += in[line * lineStep + k * step];
                out[line * lineStep + i * step] = sum / static_cast<double>(hi - lo + 1);
            }
        }
        return out;
    };
    return alongLines(alongLines(values, height, width, width, 1), width, height, 1, width);
}

/// The least of 3x3 pixels; those beyond the border are left out.
Plane leastAround(const Plane& values, std::size_t width) {
    const auto least = [](const Plane& in, std::size_t i, std::size_t place, std::size_t length,
                          std::size_t step) {
        double value = in[i];
        if (place > 0) value = std::min(value, in[i - step]);
        if (place + 1 < length) value = std::min(value, in[i + step]);
        return value;
    };
    Plane rows(values.size()), result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) rows[i] = least(values, i, i % width, width, 1);
    for (std::size_t i = 0; i < values.size(); ++i)
        result[i] = least(rows, i, i / width, values.size() / width, width);
    return result;
}

/// |difference| in standard deviations of each pixel; pixels that cannot be tested are left out.
std::vector<double> zScores(const Plane& difference, const Plane& variance, const Plane& scale,
                            const ComparedRegion& region) {
    std::vector<double> scores;
    for (std::size_t i = 0; i < difference.size(); ++i) {
        if (!region.isCompared(i)) continue;
        if (!std::isfinite(difference[i]) || !std::isfinite(variance[i])) continue;
        const double rounding = kNoiseRounding * scale[i];
        const double sigma = std::sqrt(std::max(0.0, variance[i]) + rounding * rounding);
        scores.push_back(difference[i] == 0.0 ? 0.0 : std::abs(difference[i]) / sigma);
    }
    return scores;
}

/// How many of the scores are significant at a false discovery rate of `level`.
std::uint64_t countSignificant(std::vector<double> scores, double degrees, double level) {
    const boost::math::students_t student(degrees);
    const auto tail = [&](double z) { return 2.0 * boost::math::cdf(boost::math::complement(student, z)); };
    const auto count = static_cast<double>(scores.size());
    const double least = boost::math::quantile(boost::math::complement(student, level / 2.0));
    std::erase_if(scores, [&](double z) { return z < least; });
    std::ranges::sort(scores, std::greater());
    for (std::size_t k = scores.size(); k > 0; --k)
        if (tail(std::min(scores[k - 1], 1e100)) <= level * static_cast<double>(k) / count) return k;
    return 0;
}

class PixelTest {
public:
    PixelTest(const PreparedPair& pair, double level, const Picture* second, NoiseTest& result)
        : pair_(pair), level_(level), second_(second), result_(result),
          samplesA_(samplesPerPixel(pair.a).value_or(0)), samplesB_(samplesPerPixel(pair.b).value_or(0)) {
        for (const LayerPair& layer : pair.layers)
            if (layer.part == 0 && layer.kind == LayerKind::Color && a_.empty()) {
                a_ = luminancePlane(layer, &ChannelPair::a);
                b_ = luminancePlane(layer, &ChannelPair::b);
            }
    }

    void run() {
        if (a_.empty())
            result_.source = "regions only: there is no color";
        else if (second_)
            againstSecond();
        else if (!againstVariances())
            result_.source = "regions only: there is no variance channel, or samplesPerPixel is missing";
    }

private:
    const ComparedRegion& region() const { return pair_.regions.front(); }

    Plane varianceOf(const Picture& picture) const {
        const ImageChannel* channel = picture.parts.front().image.find("variance");
        return channel ? Plane(channel->values.begin(), channel->values.end()) : Plane();
    }

    Plane scale() const {
        Plane result(a_.size());
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = std::max(std::abs(a_[i]), std::abs(b_[i]));
        return result;
    }

    bool againstVariances() {
        Plane inA = varianceOf(pair_.a), inB = varianceOf(pair_.b);
        if ((inA.empty() && inB.empty()) || samplesA_ < 2 || samplesB_ < 2) return false;
        // A variance of the mean falls with the number of samples.
        const auto fromOther = [](Plane other, double ratio) {
            for (double& v : other) v *= ratio;
            return other;
        };
        const double ratio = double(samplesB_) / double(samplesA_);
        if (inA.empty()) inA = fromOther(inB, ratio);
        if (inB.empty()) inB = fromOther(inA, 1.0 / ratio);
        Plane difference(a_.size()), variance(a_.size());
        for (std::size_t i = 0; i < a_.size(); ++i) {
            difference[i] = a_[i] - b_[i];
            variance[i] = inA[i] + inB[i];
        }
        // Few samples may all see the same by chance and show no variance: the neighbours know better.
        const Plane pooled = boxMean(variance, region().box.width(), 2);
        for (std::size_t i = 0; i < a_.size(); ++i) variance[i] = std::max(variance[i], pooled[i]);
        const std::vector<double> scores = zScores(difference, variance, scale(), region());
        result_.source = fmt::format("variance channels, {} and {} samples per pixel", samplesA_, samplesB_);
        finish(scores, countSignificant(scores, std::min(samplesA_, samplesB_) - 1, level_));
        return true;
    }

    Plane secondLuminance() const {
        PicturePart part = second_->parts.front();
        const PixelBox &has = part.dataWindow, &wanted = region().box;
        if (has.x0 > wanted.x0 || has.y0 > wanted.y0 || has.x1 < wanted.x1 || has.y1 < wanted.y1)
            throw Error(ErrorKind::InvalidContent,
                        second_->name + ": is no second render of the reference: it is smaller");
        moveTo(part, wanted);
        const auto values = [&](const char* name) { return part.image.find(name); };
        LayerPair layer;
        for (const char* name : {"R", "G", "B", "Y"})
            if (const ImageChannel* channel = values(name))
                layer.channels.push_back({name, channel, channel});
        Plane luminance = luminancePlane(layer, &ChannelPair::a);
        if (luminance.empty() || second_->scale != pair_.b.scale)
            throw Error(ErrorKind::InvalidContent,
                        second_->name +
                            ": is no second render of the reference: its colors are of another kind");
        return luminance;
    }

    /// Scores of `one` against the mean of two others, whose difference tells the noise.
    std::vector<double> scoresAgainst(const Plane& one, const Plane& other, const Plane& third,
                                      double ratio) const {
        Plane difference(one.size()), squared(one.size());
        for (std::size_t i = 0; i < one.size(); ++i) {
            difference[i] = one[i] - 0.5 * (other[i] + third[i]);
            const double d = other[i] - third[i];
            squared[i] = std::isfinite(d) ? 0.5 * d * d : 0.0;
        }
        Plane variance = boxMean(squared, region().box.width(), 3);
        for (double& v : variance) v *= ratio + 0.5; // of `one`, and of the mean of the others
        return zScores(difference, variance, scale(), region());
    }

    /// How far `one` is at least from the other two; 0 where it is not compared.
    Plane distances(const Plane& one, const Plane& other, const Plane& third) const {
        Plane result(one.size());
        for (std::size_t i = 0; i < one.size(); ++i) {
            const double d = std::min(std::abs(one[i] - other[i]), std::abs(one[i] - third[i]));
            if (region().isCompared(i) && std::isfinite(d) && d > kNoiseRounding * std::abs(one[i]))
                result[i] = d;
        }
        return result;
    }

    /// Of three renders that differ by noise alone each is as likely as the others to be the farthest from
    /// the other two. That one is so by far is left to no count: of single pixels, and of all in 3x3 pixels.
    void findOutlier(const Plane& c) {
        Plane ofA = distances(a_, b_, c), ofB = distances(b_, a_, c), ofC = distances(c, a_, b_);
        for (const double ratio : {kOutlier, kOutlierOf9}) {
            const auto farthest = std::ranges::max_element(ofA);
            const double usual = std::max(std::ranges::max(ofB), std::ranges::max(ofC));
            if (*farthest > ratio * usual && !result_.outlier) {
                const auto i = static_cast<std::size_t>(farthest - ofA.begin());
                const auto width = region().box.width();
                result_.outlier = {region().box.x0 + static_cast<std::int32_t>(i % width),
                                   region().box.y0 + static_cast<std::int32_t>(i / width), *farthest, usual};
            }
            for (Plane* const plane : {&ofA, &ofB, &ofC}) *plane = leastAround(*plane, region().box.width());
        }
    }

    void againstSecond() {
        const Plane c = secondLuminance();
        for (const auto& [plane, which] : {std::pair(&a_, "first"), {&b_, "second"}})
            if (c == *plane && a_ != b_)
                throw Error(ErrorKind::InvalidContent,
                            fmt::format("{}: shows the same noise as the {} image; render it with another "
                                        "seed",
                                        second_->name, which));
        const int samplesC = samplesPerPixel(*second_).value_or(0);
        const double ratio = samplesA_ > 0 && samplesC > 0 ? double(samplesC) / double(samplesA_) : 1.0;
        constexpr double kDegrees = 48.0; // 7x7 differences
        const std::vector<double> scores = scoresAgainst(a_, b_, c, ratio),
                                  control = scoresAgainst(c, a_, b_, 1.0);
        const std::uint64_t found = countSignificant(scores, kDegrees, level_);
        const std::uint64_t usual = countSignificant(control, kDegrees, level_);
        result_.source = fmt::format("second render {}", second_->name);
        bool isMore = false;
        if (found > 0) {
            const boost::math::binomial coin(static_cast<double>(found + usual), 0.5);
            isMore =
                boost::math::cdf(boost::math::complement(coin, static_cast<double>(found) - 1.0)) <= level_;
        }
        finish(scores, isMore ? found : 0);
        if (!scores.empty()) findOutlier(c);
    }

    void finish(const std::vector<double>& scores, std::uint64_t significant) {
        result_.pixels = scores.size();
        result_.significantPixels = significant;
        result_.largestZ = scores.empty() ? 0.0 : *std::ranges::max_element(scores);
    }

    const PreparedPair& pair_;
    double level_;
    const Picture* second_;
    NoiseTest& result_;
    int samplesA_, samplesB_;
    Plane a_, b_;
};

} // namespace

void testPixelNoise(const PreparedPair& pair, double level, const Picture* second, NoiseTest& result) {
    PixelTest(pair, level, second, result).run();
}

} // namespace rt
