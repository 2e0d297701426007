#include "tools/rt-compare/alignment.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/float_lanes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt {
namespace {

constexpr float kNotComparable = std::numeric_limits<float>::quiet_NaN();

// Of the differences that are finite: their squares, and how many they are.
RT_WIDE_LANES void addSquares(const float* a, const float* b, std::size_t size, double& sum, double& count) {
    Doubles squares{}, finite{};
    const auto add = [&](const Doubles& difference) {
        const auto isFinite = difference - difference == 0.0;
        squares += isFinite ? difference * difference : Doubles{};
        finite += isFinite ? Doubles{} + 1.0 : Doubles{};
    };
    const std::size_t whole = size / kDoubleLanes * kDoubleLanes;
    for (std::size_t i = 0; i < whole; i += kDoubleLanes) add(loadDoubles(a + i) - loadDoubles(b + i));
    for (std::size_t i = whole; i < size; ++i)
        add(Doubles{double(a[i]) - double(b[i]), kNotComparable, kNotComparable, kNotComparable});
    sum += sumOf(squares);
    count += sumOf(finite);
}

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
        std::vector<float> masked;
        const auto columns = static_cast<std::size_t>(width_ - 2 * radius_);
        for (const ChannelPair& channel : layer_.channels)
            for (int y = radius_; y < height_ - radius_; y += step) {
                const std::ptrdiff_t first = std::ptrdiff_t(y) * width_ + radius_;
                const float* a = channel.a->values.data() + first;
                const float* b =
                    channel.b->values.data() + first + std::ptrdiff_t(shift.dy) * width_ + shift.dx;
                if (!focus_.ignored.empty()) {
                    masked.assign(a, a + columns);
                    for (std::size_t x = 0; x < columns; ++x)
                        if (focus_.ignored[static_cast<std::size_t>(first) + x]) masked[x] = kNotComparable;
                    a = masked.data();
                }
                addSquares(a, b, columns, sum, count);
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
