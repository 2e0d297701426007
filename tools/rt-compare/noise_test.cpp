#include "tools/rt-compare/noise_test.h"

#include "common/error.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace rt {
namespace {

constexpr double kRounding = 0x1p-16;

using Plane = std::vector<double>;

/// Luminance of a color layer's side; empty if it has none.
Plane luminanceOf(const LayerPair& layer, const ImageChannel* ChannelPair::*side) {
    const auto values = [&](const char* name) -> const std::vector<float>* {
        const ChannelPair* channel = layer.find(name);
        return channel ? &(channel->*side)->values : nullptr;
    };
    if (const std::vector<float>* grey = values("Y")) return {grey->begin(), grey->end()};
    const std::vector<float>*r = values("R"), *g = values("G"), *b = values("B");
    if (!r || !g || !b) return {};
    Plane luminance(r->size());
    for (std::size_t i = 0; i < luminance.size(); ++i)
        luminance[i] = 0.2126 * double((*r)[i]) + 0.7152 * double((*g)[i]) + 0.0722 * double((*b)[i]);
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

int samplesOf(const Picture& picture) {
    const auto& ints = picture.parts.front().image.ints;
    const auto found = ints.find("samplesPerPixel");
    return found == ints.end() ? 0 : std::max(0, found->second);
}

/// |difference| in standard deviations of each pixel; pixels that cannot be tested are left out.
std::vector<double> zScores(const Plane& difference, const Plane& variance, const Plane& scale,
                            const Focus& focus) {
    std::vector<double> scores;
    for (std::size_t i = 0; i < difference.size(); ++i) {
        if (!focus.ignored.empty() && focus.ignored[i]) continue;
        if (!std::isfinite(difference[i]) || !std::isfinite(variance[i])) continue;
        const double rounding = kRounding * scale[i];
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
    PixelTest(const PreparedPair& pair, const NoiseOptions& options, NoiseTest& result)
        : pair_(pair), options_(options), result_(result), samplesA_(samplesOf(pair.a)),
          samplesB_(samplesOf(pair.b)) {
        for (const LayerPair& layer : pair.layers)
            if (layer.part == 0 && layer.kind == LayerKind::Color && a_.empty()) {
                a_ = luminanceOf(layer, &ChannelPair::a);
                b_ = luminanceOf(layer, &ChannelPair::b);
            }
    }

    void run() {
        if (a_.empty())
            result_.source = "regions only: there is no color";
        else if (options_.second)
            againstSecond();
        else if (!againstVariances())
            result_.source = "regions only: there is no variance channel, or samplesPerPixel is missing";
    }

private:
    const Focus& focus() const { return pair_.focus.front(); }

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
        const Plane pooled = boxMean(variance, focus().box.width(), 2);
        for (std::size_t i = 0; i < a_.size(); ++i) variance[i] = std::max(variance[i], pooled[i]);
        const std::vector<double> scores = zScores(difference, variance, scale(), focus());
        result_.source = fmt::format("variance channels, {} and {} samples per pixel", samplesA_, samplesB_);
        finish(scores, countSignificant(scores, std::min(samplesA_, samplesB_) - 1, options_.level / 2.0));
        return true;
    }

    Plane secondLuminance() const {
        PicturePart part = options_.second->parts.front();
        const PixelBox &has = part.dataWindow, &wanted = focus().box;
        if (has.x0 > wanted.x0 || has.y0 > wanted.y0 || has.x1 < wanted.x1 || has.y1 < wanted.y1)
            throw Error(ErrorKind::InvalidContent,
                        options_.second->name + ": is no second render of the reference: it is smaller");
        moveTo(part, wanted);
        const auto values = [&](const char* name) { return part.image.find(name); };
        LayerPair layer;
        for (const char* name : {"R", "G", "B", "Y"})
            if (const ImageChannel* channel = values(name))
                layer.channels.push_back({name, channel, channel});
        Plane luminance = luminanceOf(layer, &ChannelPair::a);
        if (luminance.empty() || options_.second->scale != pair_.b.scale)
            throw Error(ErrorKind::InvalidContent,
                        options_.second->name +
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
        Plane variance = boxMean(squared, focus().box.width(), 3);
        for (double& v : variance) v *= ratio + 0.5; // of `one`, and of the mean of the others
        return zScores(difference, variance, scale(), focus());
    }

    void againstSecond() {
        const Plane c = secondLuminance();
        const int samplesC = samplesOf(*options_.second);
        const double ratio = samplesA_ > 0 && samplesC > 0 ? double(samplesC) / double(samplesA_) : 1.0;
        constexpr double kDegrees = 48.0; // 7x7 differences
        const std::vector<double> scores = scoresAgainst(a_, b_, c, ratio),
                                  control = scoresAgainst(c, a_, b_, 1.0);
        const double level = options_.level / 2.0;
        const std::uint64_t found = countSignificant(scores, kDegrees, level);
        const std::uint64_t usual = countSignificant(control, kDegrees, level);
        result_.source = fmt::format("second render {}", options_.second->name);
        bool isMore = false;
        if (found > 0) {
            const boost::math::binomial coin(static_cast<double>(found + usual), 0.5);
            isMore =
                boost::math::cdf(boost::math::complement(coin, static_cast<double>(found) - 1.0)) <= level;
        }
        finish(scores, isMore ? found : 0);
    }

    void finish(const std::vector<double>& scores, std::uint64_t significant) {
        result_.pixels = scores.size();
        result_.significantPixels = significant;
        result_.largestZ = scores.empty() ? 0.0 : *std::ranges::max_element(scores);
    }

    const PreparedPair& pair_;
    const NoiseOptions& options_;
    NoiseTest& result_;
    int samplesA_, samplesB_;
    Plane a_, b_;
};

/// Sums over regions that lie side by side, all of the same size.
struct Regions {
    struct Sums {
        double difference = 0.0, squares = 0.0, reference = 0.0, pixels = 0.0;

        void add(const Sums& other) {
            difference += other.difference;
            squares += other.squares;
            reference += other.reference;
            pixels += other.pixels;
        }
    };
    std::size_t side = 0, columns = 0; ///< in pixels, in regions
    std::vector<Sums> sums;

    Regions(const PixelBox& box, std::size_t s)
        : side(s), columns((box.width() + s - 1) / s), sums(columns * ((box.height() + s - 1) / s)) {}
    Sums& at(std::size_t x, std::size_t y) { return sums[y / side * columns + x / side]; }
};

class RegionTest {
public:
    RegionTest(const PreparedPair& pair, const NoiseOptions& options, NoiseTest& result)
        : pair_(pair), options_(options), result_(result) {}

    void run() {
        for (const LayerPair& layer : pair_.layers) {
            if (layer.kind == LayerKind::Ids) continue;
            for (const ChannelPair& channel : layer.channels)
                if (channel.a->name != "variance") testChannel(channel, pair_.focus[layer.part]);
        }
        const double level =
            options_.level / 2.0 / static_cast<double>(std::max<std::uint64_t>(result_.regions, 1));
        const double squaresNeeded = 2.0 * std::log(2.0 / level); // for a bias of all of them to be seen
        for (const Seen& channel : seen_)
            if (channel.differs && channel.squares < squaresNeeded) result_.tooSmall.push_back(channel.name);
        std::erase_if(candidates_,
                      [&](const NoiseTest::Region& region) { return region.probability > level; });
        std::ranges::stable_sort(candidates_, {}, &NoiseTest::Region::probability);
        result_.significantRegionCount = candidates_.size();
        constexpr std::size_t kShown = 10;
        if (candidates_.size() > kShown) candidates_.resize(kShown);
        result_.significantRegions = std::move(candidates_);
    }

private:
    static constexpr std::size_t kSquare = 8, kSmallest = 64; // sides in pixels
    static constexpr double kLost = 0.9;                      // of a value

    struct Seen {
        std::string name;
        bool differs = false;
        double squares = 0.0; ///< that hold pixels to compare
    };

    Regions smallestRegions(const ChannelPair& channel, const Focus& focus) {
        const std::size_t width = focus.box.width();
        Regions squares(focus.box, kSquare), regions(focus.box, kSmallest);
        std::vector<std::array<int, 2>> lost(squares.sums.size()); // pixels, by the picture that lost them
        Seen& seen = seen_.emplace_back(channel.name);
        for (std::size_t i = 0; i < channel.a->values.size(); ++i) {
            const double a = channel.a->values[i], b = channel.b->values[i];
            if ((!focus.ignored.empty() && focus.ignored[i]) || !std::isfinite(a - b)) continue;
            const bool isRounding = std::abs(a - b) <= kRounding * std::max(std::abs(a), std::abs(b));
            seen.differs = seen.differs || !isRounding;
            Regions::Sums& square = squares.at(i % width, i / width);
            square.add({isRounding ? 0.0 : a - b, 0.0, b, 1.0});
            if (std::abs(a - b) >= kLost * std::max(std::abs(a), std::abs(b)) && !isRounding)
                ++lost[std::size_t(&square - squares.sums.data())][std::abs(a) < std::abs(b) ? 0 : 1];
        }
        for (const Regions::Sums& square : squares.sums) seen.squares += square.pixels > 0.0 ? 1.0 : 0.0;
        testSquares(channel, focus, squares, lost);
        for (std::size_t i = 0; i < squares.sums.size(); ++i) {
            Regions::Sums& square = squares.sums[i];
            square.squares = square.difference * square.difference;
            regions.at(i % squares.columns * kSquare, i / squares.columns * kSquare).add(square);
        }
        return regions;
    }

    void testSquares(const ChannelPair& channel, const Focus& focus, const Regions& squares,
                     const std::vector<std::array<int, 2>>& lost) {
        for (std::size_t i = 0; i < lost.size(); ++i) {
            if (std::min(lost[i][0], lost[i][1]) > 0) continue;
            const double probability = std::exp2(1.0 - std::max(lost[i][0], lost[i][1]));
            if (probability * static_cast<double>(lost.size()) <= 1e-3 * options_.level)
                addCandidate(channel, focus, squares, i, probability);
        }
    }

    void testChannel(const ChannelPair& channel, const Focus& focus) {
        for (Regions regions = smallestRegions(channel, focus);;) {
            for (std::size_t i = 0; i < regions.sums.size(); ++i) testRegion(channel, focus, regions, i);
            if (regions.sums.size() <= 1) return; // that was the whole picture
            Regions larger(focus.box, regions.side * 2);
            for (std::size_t i = 0; i < regions.sums.size(); ++i)
                larger.at(i % regions.columns * regions.side, i / regions.columns * regions.side)
                    .add(regions.sums[i]);
            regions = std::move(larger);
        }
    }

    void testRegion(const ChannelPair& channel, const Focus& focus, const Regions& regions,
                    std::size_t index) {
        const Regions::Sums& sums = regions.sums[index];
        if (sums.pixels == 0.0) return;
        ++result_.regions;
        const double square = sums.difference * sums.difference;
        const double probability =
            square > 0.0 ? std::min(1.0, 2.0 * std::exp(-0.5 * square / sums.squares)) : 1.0;
        if (probability <= options_.level) addCandidate(channel, focus, regions, index, probability);
    }

    void addCandidate(const ChannelPair& channel, const Focus& focus, const Regions& regions,
                      std::size_t index, double probability) {
        const Regions::Sums& sums = regions.sums[index];
        const auto side = static_cast<std::int32_t>(regions.side);
        const PixelBox& box = focus.box;
        PixelBox region;
        region.x0 = box.x0 + static_cast<std::int32_t>(index % regions.columns) * side;
        region.y0 = box.y0 + static_cast<std::int32_t>(index / regions.columns) * side;
        region.x1 = std::min(box.x1, region.x0 + side);
        region.y1 = std::min(box.y1, region.y0 + side);
        candidates_.push_back({channel.name, region, sums.difference / sums.pixels,
                               sums.difference / sums.reference, probability});
    }

    const PreparedPair& pair_;
    const NoiseOptions& options_;
    NoiseTest& result_;
    std::vector<NoiseTest::Region> candidates_;
    std::vector<Seen> seen_; ///< of each channel
};

} // namespace

NoiseTest testNoise(const PreparedPair& pair, const NoiseOptions& options) {
    NoiseTest result;
    result.level = options.level;
    PixelTest(pair, options, result).run();
    RegionTest(pair, options, result).run();
    return result;
}

} // namespace rt
