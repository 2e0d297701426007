#include "tools/rt-compare/alignment.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

class ShiftSearch {
public:
    ShiftSearch(const LayerPair& layer, const ComparedRegion& focus, int radius)
        : layer_(layer), focus_(focus), radius_(radius), width_(static_cast<int>(focus.box.width())),
          height_(static_cast<int>(focus.box.height())) {
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx) candidates_.push_back({dx, dy});
    }

    Alignment run() {
        constexpr int kFewPixels = 1 << 15, kManyPixels = 1 << 20;
        constexpr std::size_t kFinalists = 4;
        measure(kFewPixels);
        std::ranges::stable_sort(candidates_, {}, &Alignment::rmse);
        candidates_.resize(std::min(candidates_.size(), kFinalists));
        candidates_.push_back({});
        measure(kManyPixels);
        const double inPlace = candidates_.back().rmse;
        Alignment best = *std::ranges::min_element(candidates_, {}, &Alignment::rmse);
        // Of noise some shift is always the best, by a little.
        constexpr double kClearly = 0.9;
        if (!(best.rmse < kClearly * inPlace)) best = {0, 0, inPlace};
        best.rmseInPlace = inPlace;
        return best;
    }

private:
    // Over evenly spaced rows of about so many pixels together.
    void measure(int pixels) {
        const int step = std::max(1, (height_ - 2 * radius_) * (width_ - 2 * radius_) / pixels);
        tbb::parallel_for(std::size_t(0), candidates_.size(),
                          [&](std::size_t i) { candidates_[i].rmse = rmseOf(candidates_[i], step); });
    }

    double rmseOf(const Alignment& shift, int step) const {
        double sum = 0.0, count = 0.0;
        for (const ChannelPair& channel : layer_.channels) {
            for (int y = radius_; y < height_ - radius_; y += step) {
                const std::size_t row = std::size_t(y) * std::size_t(width_);
                const float* a = channel.a->values.data() + row;
                const float* b = channel.b->values.data() + std::ptrdiff_t(row) +
                                 std::ptrdiff_t(shift.dy) * width_ + shift.dx;
                const std::uint8_t* ignored = focus_.ignored.empty() ? nullptr : focus_.ignored.data() + row;
                for (int x = radius_; x < width_ - radius_; ++x) {
                    const double difference = double(a[x]) - double(b[x]);
                    if ((ignored && ignored[x]) || !std::isfinite(difference)) continue;
                    sum += difference * difference;
                    count += 1.0;
                }
            }
        }
        return count > 0.0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
    }

    const LayerPair& layer_;
    const ComparedRegion& focus_;
    int radius_, width_, height_;
    std::vector<Alignment> candidates_;
};

} // namespace

std::optional<Alignment> findAlignment(const PreparedPair& pair, const Comparison& comparison, int maxShift) {
    for (std::size_t i = 0; i < pair.layers.size(); ++i) {
        if (pair.layers[i].kind == LayerKind::Ids) continue;
        const bool differs = comparison.layers[i].figures.maxAbs > 0.0;
        const PixelBox& box = pair.regions[pair.layers[i].part].box;
        const int radius = std::min(maxShift, static_cast<int>(std::min(box.width(), box.height())) / 4);
        if (!differs || radius < 1) return std::nullopt;
        return ShiftSearch(pair.layers[i], pair.regions[pair.layers[i].part], radius).run();
    }
    return std::nullopt;
}

} // namespace rt
