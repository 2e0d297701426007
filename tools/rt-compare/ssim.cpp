#include "tools/rt-compare/ssim.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/float_lanes.h"
#include "tools/rt-compare/ssim_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

constexpr std::size_t kRadius = 5, kMargins = 2 * kRadius;                    // of a window of 11x11 pixels
constexpr double kDeviation = 1.5;                                            // pixels
constexpr double kGuardLuminance = 0.01 * 0.01, kGuardContrast = 0.03 * 0.03; // (K L)^2 for L = 1
constexpr std::array<double, 5> kScaleWeights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

// Of windows: a row of moments, and the pixels below them, stay in the nearest cache.
constexpr std::size_t kTileWidth = 128, kTileHeight = 32;
static_assert(kTileWidth % kLanes == 0 && kTileWidth + kMargins <= kTileWidth + SsimPyramid::kSlack);

/// Half of a Gaussian window along a line: at distances 0 to kRadius.
using Window = std::array<float, kRadius + 1>;

Window gaussianWindow() {
    const auto gauss = [](double x) { return std::exp(-x * x / (2.0 * kDeviation * kDeviation)); };
    double sum = gauss(0.0), outer = 0.0;
    for (std::size_t i = 1; i <= kRadius; ++i) sum += 2.0 * gauss(double(i));
    Window window;
    for (std::size_t i = 1; i <= kRadius; ++i) {
        window[i] = static_cast<float>(gauss(double(i)) / sum);
        outer += 2.0 * double(window[i]);
    }
    window[0] = static_cast<float>(1.0 - outer); // so that the rounded weights add up to 1
    return window;
}

/// A row of local means: of the sum, the difference, and their squares.
struct Moments {
    static constexpr std::size_t kWidth = kTileWidth + 2 * kLanes; // with the margins of its windows
    float sum[kWidth], difference[kWidth], sumSquare[kWidth], differenceSquare[kWidth];
};

struct SsimTile {
    const SsimLevel* level = nullptr;
    std::size_t x0 = 0, y0 = 0, x1 = 0, y1 = 0; // of the first row and column of its windows
    // 1 - SSIM and 1 - contrast times structure, which keep their digits where pictures are alike.
    double loss = 0.0, contrastLoss = 0.0;
    std::size_t windows = 0; // whose middle counts
    float* map = nullptr;    // of the level's size, if wanted: where SSIM goes
};

// Of kLanes columns: the means over the 11 rows from `row` on.
inline void filterAlongY(const SsimLevel& level, const Window& window, std::size_t at, std::size_t x,
                         Moments& to) {
    const float* const sum = level.sum.data() + at;
    const float* const difference = level.difference.data() + at;
    const auto rowOf = [&](std::size_t row) { return row * level.stride + x; };
    const Floats s = loadFloats(sum + rowOf(kRadius)), d = loadFloats(difference + rowOf(kRadius));
    Floats means[4] = {window[0] * s, window[0] * d, window[0] * (s * s), window[0] * (d * d)};
    for (std::size_t i = 1; i <= kRadius; ++i) {
        const std::size_t above = rowOf(kRadius - i), below = rowOf(kRadius + i);
        const Floats s0 = loadFloats(sum + above), s1 = loadFloats(sum + below);
        const Floats d0 = loadFloats(difference + above), d1 = loadFloats(difference + below);
        means[0] += window[i] * (s0 + s1);
        means[1] += window[i] * (d0 + d1);
        means[2] += window[i] * (s0 * s0 + s1 * s1);
        means[3] += window[i] * (d0 * d0 + d1 * d1);
    }
    storeFloats(to.sum + x, means[0]);
    storeFloats(to.difference + x, means[1]);
    storeFloats(to.sumSquare + x, means[2]);
    storeFloats(to.differenceSquare + x, means[3]);
}

inline Floats filteredAlongX(const float* from, const Window& window) {
    Floats mean = window[0] * loadFloats(from + kRadius);
    for (std::size_t i = 1; i <= kRadius; ++i)
        mean += window[i] * (loadFloats(from + kRadius - i) + loadFloats(from + kRadius + i));
    return mean;
}

struct Losses {
    Floats all, contrast;
};

// With s = a + b and d = a - b, 2ab / (a^2 + b^2) is 1 - 2d^2 / (s^2 + d^2), of means and of deviations.
inline Losses lossesOf(const Moments& moments, const Window& window, std::size_t x) {
    constexpr auto kLuminance = float(2.0 * kGuardLuminance), kContrast = float(2.0 * kGuardContrast);
    const Floats centered = filteredAlongX(moments.sum + x, window);
    const Floats difference = filteredAlongX(moments.difference + x, window),
                 square = difference * difference;
    const Floats sumVariance = filteredAlongX(moments.sumSquare + x, window) - centered * centered;
    const Floats differenceVariance = filteredAlongX(moments.differenceSquare + x, window) - square;
    const Floats sum = centered + 1.0f;
    const Floats luminance = 2.0f * square / (sum * sum + square + kLuminance);
    const Floats contrast = 2.0f * differenceVariance / (sumVariance + differenceVariance + kContrast);
    return {luminance + contrast - luminance * contrast, contrast};
}

RT_WIDE_LANES void measureTile(SsimTile& tile, const Window& window) {
    const SsimLevel& level = *tile.level;
    const std::size_t columns = tile.x1 - tile.x0, padded = (columns + kLanes - 1) / kLanes * kLanes;
    Moments moments;
    float losses[2][kTileWidth];
    Doubles sums[2] = {};
    for (std::size_t y = tile.y0; y < tile.y1; ++y) {
        for (std::size_t x = 0; x < padded + kMargins; x += kLanes)
            filterAlongY(level, window, y * level.stride + tile.x0, x, moments);
        for (std::size_t x = 0; x < padded; x += kLanes) {
            const Losses found = lossesOf(moments, window, x);
            storeFloats(losses[0] + x, found.all);
            storeFloats(losses[1] + x, found.contrast);
        }
        const std::size_t middle = (y + kRadius) * level.width + tile.x0 + kRadius;
        for (std::size_t x = 0; tile.map && x < columns; ++x) tile.map[middle + x] = 1.0f - losses[0][x];
        for (float* const row : losses) {
            for (std::size_t x = 0; !level.ignored.empty() && x < columns; ++x)
                row[x] = level.ignored[middle + x] ? 0.0f : row[x];
            std::fill(row + columns, row + kTileWidth, 0.0f);
        }
        for (int i = 0; i < 2; ++i)
            for (std::size_t x = 0; x < padded; x += kDoubleLanes) sums[i] += loadDoubles(losses[i] + x);
        tile.windows += columns;
        for (std::size_t x = 0; !level.ignored.empty() && x < columns; ++x)
            tile.windows -= level.ignored[middle + x] ? 1u : 0u;
    }
    tile.loss = sumOf(sums[0]);
    tile.contrastLoss = sumOf(sums[1]);
}

void addTiles(const SsimLevel& level, float* map, std::vector<SsimTile>& tiles) {
    const std::size_t columns = level.width - kMargins, rows = level.height - kMargins;
    for (std::size_t y = 0; y < rows; y += kTileHeight)
        for (std::size_t x = 0; x < columns; x += kTileWidth)
            tiles.push_back({.level = &level,
                             .x0 = x,
                             .y0 = y,
                             .x1 = std::min(x + kTileWidth, columns),
                             .y1 = std::min(y + kTileHeight, rows),
                             .map = map});
}

// Pixels at the edges have what the nearest has whose window lies in the picture.
void fillEdges(const SsimLevel& level, std::vector<float>& map) {
    const std::size_t width = level.width, last = level.height - 1 - kRadius;
    for (std::size_t y = kRadius; y <= last; ++y) {
        float* const row = map.data() + y * width;
        std::fill(row, row + kRadius, row[kRadius]);
        std::fill(row + width - kRadius, row + width, row[width - 1 - kRadius]);
    }
    for (std::size_t i = 0; i < kRadius; ++i) {
        std::copy_n(map.data() + kRadius * width, width, map.data() + i * width);
        std::copy_n(map.data() + last * width, width, map.data() + (last + 1 + i) * width);
    }
}

struct Similarity {
    double all = 1.0, contrast = 1.0; // where no window counts
};

// Tiles are added in their order, whoever measured them.
Similarity similarityOf(const SsimLevel& level, const std::vector<SsimTile>& tiles) {
    SsimTile total;
    for (const SsimTile& tile : tiles) {
        if (tile.level != &level) continue;
        total.loss += tile.loss;
        total.contrastLoss += tile.contrastLoss;
        total.windows += tile.windows;
    }
    if (total.windows == 0) return {};
    const auto count = static_cast<double>(total.windows);
    return {1.0 - total.loss / count, 1.0 - total.contrastLoss / count};
}

double multiScale(const std::vector<SsimLevel>& levels, const std::vector<SsimTile>& tiles) {
    double product = 1.0;
    for (std::size_t scale = 0; scale < levels.size(); ++scale) {
        const Similarity found = similarityOf(levels[scale], tiles);
        const bool isLast = scale + 1 == levels.size();
        // Negative means (one picture is rather the negative of the other) have no such power: no similarity.
        product *= std::pow(std::max(isLast ? found.all : found.contrast, 0.0), kScaleWeights[scale]);
    }
    return product;
}

} // namespace

SsimMeter::SsimMeter() : pyramid_(std::make_unique<SsimPyramid>()) {}
SsimMeter::~SsimMeter() = default;

SsimFigures SsimMeter::measure(const SsimPlanes& planes, const SsimWants& wants) {
    SsimFigures figures;
    if (wants.map) figures.map.assign(std::size_t(planes.width) * planes.height, 1.0f);
    const std::uint32_t least = std::min(planes.width, planes.height);
    if (least < kSsimLeast) return figures;
    const bool isMulti = wants.multi && least >= kMsSsimLeast;
    pyramid_->build(planes, isMulti ? kScaleWeights.size() : 1);
    const std::vector<SsimLevel>& levels = pyramid_->levels();
    std::vector<SsimTile> tiles;
    for (const SsimLevel& level : levels)
        addTiles(level, wants.map && &level == &levels[0] ? figures.map.data() : nullptr, tiles);
    const Window window = gaussianWindow();
    tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t i) { measureTile(tiles[i], window); });
    if (wants.map) fillEdges(levels[0], figures.map);
    if (wants.single) figures.single = similarityOf(levels[0], tiles).all;
    if (isMulti) figures.multi = multiScale(levels, tiles);
    return figures;
}

SsimFigures measureSsim(const SsimPlanes& planes, const SsimWants& wants) {
    return SsimMeter().measure(planes, wants);
}

} // namespace rt
