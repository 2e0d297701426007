#include "tools/rt-compare/noise_stages.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

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
    RegionTest(const PreparedPair& pair, double level, NoiseTest& result)
        : pair_(pair), level_(level), result_(result) {}

    void run() {
        for (const LayerPair& layer : pair_.layers) {
            if (layer.kind == LayerKind::Ids) continue;
            for (const ChannelPair& channel : layer.channels)
                if (channel.a->name != "variance" || tookAsManySamples())
                    testChannel(channel, pair_.regions[layer.part]);
        }
        const double level = level_ / static_cast<double>(std::max<std::uint64_t>(result_.regions, 1));
        const double squaresNeeded = 2.0 * std::log(2.0 / level); // for a bias of all of them to be seen
        for (const Seen& channel : seen_) {
            if (channel.differs && channel.squares < squaresNeeded) result_.tooSmall.push_back(channel.name);
            if (channel.differs && result_.pixels == 0) result_.untested.push_back(channel.name);
        }
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

    // Else the variances of their means differ too.
    bool tookAsManySamples() const { return samplesPerPixel(pair_.a) == samplesPerPixel(pair_.b); }

    struct Seen {
        std::string name;
        bool differs = false;
        double squares = 0.0; ///< that hold pixels to compare
    };

    Regions smallestRegions(const ChannelPair& channel, const ComparedRegion& compared) {
        const std::size_t width = compared.box.width();
        Regions squares(compared.box, kSquare), regions(compared.box, kSmallest);
        std::vector<std::array<int, 2>> lost(squares.sums.size()); // pixels, by the picture that lost them
        Seen& seen = seen_.emplace_back(channel.name);
        for (std::size_t i = 0; i < channel.a->values.size(); ++i) {
            const double a = channel.a->values[i], b = channel.b->values[i];
            if (!compared.isCompared(i) || !std::isfinite(a - b)) continue;
            const bool isRounding = std::abs(a - b) <= kNoiseRounding * std::max(std::abs(a), std::abs(b));
            seen.differs = seen.differs || !isRounding;
            Regions::Sums& square = squares.at(i % width, i / width);
            square.add({isRounding ? 0.0 : a - b, 0.0, b, 1.0});
            if (std::abs(a - b) >= kLost * std::max(std::abs(a), std::abs(b)) && !isRounding)
                ++lost[std::size_t(&square - squares.sums.data())][std::abs(a) < std::abs(b) ? 0 : 1];
        }
        for (const Regions::Sums& square : squares.sums) seen.squares += square.pixels > 0.0 ? 1.0 : 0.0;
        testSquares(channel, compared, squares, lost);
        for (std::size_t i = 0; i < squares.sums.size(); ++i) {
            Regions::Sums& square = squares.sums[i];
            square.squares = square.difference * square.difference;
            regions.at(i % squares.columns * kSquare, i / squares.columns * kSquare).add(square);
        }
        return regions;
    }

    void testSquares(const ChannelPair& channel, const ComparedRegion& compared, const Regions& squares,
                     const std::vector<std::array<int, 2>>& lost) {
        for (std::size_t i = 0; i < lost.size(); ++i) {
            if (std::min(lost[i][0], lost[i][1]) > 0) continue;
            const double probability = std::exp2(1.0 - std::max(lost[i][0], lost[i][1]));
            if (probability * static_cast<double>(lost.size()) <= 2e-3 * level_)
                addCandidate(channel, compared, squares, i, probability);
        }
    }

    void testChannel(const ChannelPair& channel, const ComparedRegion& compared) {
        for (Regions regions = smallestRegions(channel, compared);;) {
            for (std::size_t i = 0; i < regions.sums.size(); ++i) testRegion(channel, compared, regions, i);
            if (regions.sums.size() <= 1) return; // that was the whole picture
            Regions larger(compared.box, regions.side * 2);
            for (std::size_t i = 0; i < regions.sums.size(); ++i)
                larger.at(i % regions.columns * regions.side, i / regions.columns * regions.side)
                    .add(regions.sums[i]);
            regions = std::move(larger);
        }
    }

    void testRegion(const ChannelPair& channel, const ComparedRegion& compared, const Regions& regions,
                    std::size_t index) {
        const Regions::Sums& sums = regions.sums[index];
        if (sums.pixels == 0.0) return;
        ++result_.regions;
        const double square = sums.difference * sums.difference;
        const double probability =
            square > 0.0 ? std::min(1.0, 2.0 * std::exp(-0.5 * square / sums.squares)) : 1.0;
        if (probability <= 2.0 * level_) addCandidate(channel, compared, regions, index, probability);
    }

    void addCandidate(const ChannelPair& channel, const ComparedRegion& compared, const Regions& regions,
                      std::size_t index, double probability) {
        const Regions::Sums& sums = regions.sums[index];
        const auto side = static_cast<std::int32_t>(regions.side);
        const PixelBox& box = compared.box;
        PixelBox region;
        region.x0 = box.x0 + static_cast<std::int32_t>(index % regions.columns) * side;
        region.y0 = box.y0 + static_cast<std::int32_t>(index / regions.columns) * side;
        region.x1 = std::min(box.x1, region.x0 + side);
        region.y1 = std::min(box.y1, region.y0 + side);
        candidates_.push_back({channel.name, region, sums.difference / sums.pixels,
                               sums.difference / sums.reference, probability});
    }

    const PreparedPair& pair_;
    double level_;
    NoiseTest& result_;
    std::vector<NoiseTest::Region> candidates_;
    std::vector<Seen> seen_; ///< of each channel
};

} // namespace

void testRegionNoise(const PreparedPair& pair, double level, NoiseTest& result) {
    RegionTest(pair, level, result).run();
}

} // namespace rt
