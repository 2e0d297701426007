#include "tools/rt-compare/flip_tile.h"

#include "common/wide_lanes.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr int kLaneCount = static_cast<int>(kLanes);
constexpr int kStep = 2 * kLaneCount; // columns at a time: enough sums to hide each other's wait

// What a row becomes along x; along y each goes on through its own filter.
enum Line { kY, kCx, kCzWide, kCzNarrow, kSmooth, kEdge, kPoint, kLineCount };
constexpr std::size_t kRowFloats = std::size_t(kLineCount) * kFlipTileWidth;

struct FloatsPair {
    Floats low, high; // of kStep columns
};

inline FloatsPair loadPair(const float* from) {
    return {loadFloats(from), loadFloats(from + kLanes)};
}

// The sum over at(-radius) ... at(radius), pointers to kStep values each.
template <class At>
inline FloatsPair filteredEven(const LineFilter& filter, At&& at) {
    const float* const weights = filter.weights.data();
    FloatsPair sum = loadPair(at(0));
    sum.low *= weights[0];
    sum.high *= weights[0];
    for (int i = 1; i <= filter.radius(); ++i) {
        const FloatsPair after = loadPair(at(i)), before = loadPair(at(-i));
        sum.low += weights[i] * (after.low + before.low);
        sum.high += weights[i] * (after.high + before.high);
    }
    return sum;
}

template <class At>
inline FloatsPair filteredOdd(const LineFilter& filter, At&& at) {
    const float* const weights = filter.weights.data();
    FloatsPair sum{};
    for (int i = 1; i <= filter.radius(); ++i) {
        const FloatsPair after = loadPair(at(i)), before = loadPair(at(-i));
        sum.low += weights[i] * (after.low - before.low);
        sum.high += weights[i] * (after.high - before.high);
    }
    return sum;
}

// One picture as the eye's filter leaves it, and how strong its edges and points are.
struct Seen {
    FloatsTriple opponent;
    Floats edge, point;
};

inline Floats lengthOf(const Floats& x, const Floats& y) {
    return squareRoot(x * x + y * y);
}

// Source: Andersson et al. 2020, sections 4.1.3, 4.2.2 and 4.3.
inline Floats flipError(const FlipColors& colors, const Seen& a, const Seen& b) {
    constexpr float kSplit = 0.4f, kSplitError = 0.95f; // this part of the differences gets most of the range
    const Floats difference =
        power(hyAb(huntLabOfOpponent(colors, a.opponent), huntLabOfOpponent(colors, b.opponent)),
              allFloats(kColorExponent));
    const float most = colors.largestDifference, split = kSplit * most;
    const Floats above = kSplitError + (difference - split) * ((1.0f - kSplitError) / (most - split));
    const Floats color = difference < split ? difference * (kSplitError / split) : above;
    // Edges and points were found in Y, which is 116 times as large as the paper's.
    const Floats wider = greater(absolute(a.edge - b.edge), absolute(a.point - b.point));
    const Floats feature = squareRoot(wider * (0.70710678f / 116.0f));
    return clampToUnit(power(color, clampToUnit(1.0f - feature)));
}

} // namespace

FlipColors::FlipColors() {
    glm::dmat3 relative; // column-major
    for (int row = 0; row < 3; ++row) {
        const double* const m = kXyzFromRgb[row];
        for (int column = 0; column < 3; ++column) relative[column][row] = m[column] / (m[0] + m[1] + m[2]);
    }
    const glm::dmat3 inverse = glm::inverse(relative);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            relativeXyzFromRgb[row][column] = static_cast<float>(relative[column][row]);
            rgbFromRelativeXyz[row][column] = static_cast<float>(inverse[column][row]);
        }
    const Floats none = allFloats(0.0f), full = allFloats(1.0f);
    const Floats difference =
        hyAb(huntLabOf(*this, {none, full, none}), huntLabOf(*this, {none, none, full}));
    largestDifference = power(difference, allFloats(kColorExponent))[0];
}

void FlipTile::resize(const FlipFilters& filters) {
    margin_ = (filters.radius + kLaneCount - 1) / kLaneCount * kLaneCount;
    stride_ = kFlipTileWidth + 2 * margin_;
    const auto ringRows = static_cast<std::size_t>(2 * filters.radius + 1);
    channels_.resize(3 * static_cast<std::size_t>(stride_));
    errors_.resize(kFlipTileWidth);
    for (int i = 0; i < 2; ++i) {
        lines_[i].resize(ringRows * kRowFloats);
        rows_[i].resize(ringRows);
    }
}

// The picture goes on beyond its edges as at them.
inline void FlipTile::loadRow(const FlipTask& task, const ColorPlanes& picture, int x0, int y) {
    const int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    const int left = x0 - margin_, first = std::max(left, 0), end = std::min(left + stride_, width);
    const std::size_t row = static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * picture.width;
    for (std::size_t c = 0; c < 3; ++c) {
        const float* const from = picture.planes[c].data() + row;
        float* const to = channels_.data() + c * static_cast<std::size_t>(stride_);
        std::fill(to, to + (first - left), from[first]);
        std::copy(from + first, from + end, to + (first - left));
        std::fill(to + (end - left), to + stride_, from[end - 1]);
    }
    toOpponents(task, picture);
}

inline void FlipTile::toOpponents(const FlipTask& task, const ColorPlanes& picture) {
    const Floats none = allFloats(0.0f), bright = allFloats(1e6f); // the tone map's end is far below
    float* const r = channels_.data();
    float* const g = r + stride_;
    float* const b = g + stride_;
    for (int x = 0; x < stride_; x += kLaneCount) {
        Floats rgb[3] = {loadFloats(r + x), loadFloats(g + x), loadFloats(b + x)};
        for (Floats& v : rgb) {
            v = v - v == 0.0f ? v : none;
            if (task.exposure) v = acesToneMapped(greater(lesser(v * *task.exposure, bright), none));
            v = clampToUnit(v);
            if (picture.encoding == ColorPlanes::Encoding::Srgb) v = decodedSrgb(v);
        }
        const FloatsTriple opponent = opponentOf(task.colors, {rgb[0], rgb[1], rgb[2]});
        storeFloats(r + x, opponent.x);
        storeFloats(g + x, opponent.y);
        storeFloats(b + x, opponent.z);
    }
}

inline void FlipTile::filterAlongX(const FlipFilters& filters, int columns, float* lines) const {
    const float* const y = channels_.data() + margin_;
    const float* const cx = y + stride_;
    const float* const cz = cx + stride_;
    for (int x = 0; x < columns; x += kStep) {
        const auto put = [&](Line line, const FloatsPair& values) {
            float* const to = lines + line * kFlipTileWidth + x;
            storeFloats(to, values.low);
            storeFloats(to + kLanes, values.high);
        };
        const auto at = [x](const float* row) { return [row, x](int i) { return row + (x + i); }; };
        put(kY, filteredEven(filters.achromatic, at(y)));
        put(kCx, filteredEven(filters.redGreen, at(cx)));
        put(kCzWide, filteredEven(filters.blueYellowWide, at(cz)));
        put(kCzNarrow, filteredEven(filters.blueYellowNarrow, at(cz)));
        put(kSmooth, filteredEven(filters.smooth, at(y)));
        put(kEdge, filteredOdd(filters.edge, at(y)));
        put(kPoint, filteredEven(filters.point, at(y)));
    }
}

inline void FlipTile::filterAlongY(const FlipTask& task, int columns) {
    const FlipFilters& filters = task.filters;
    for (int x = 0; x < columns; x += kStep) {
        Seen low[2], high[2];
        for (int i = 0; i < 2; ++i) {
            const float* const* const rows = rows_[i].data() + filters.radius;
            const auto at = [rows, x](Line line) {
                return [rows, offset = line * kFlipTileWidth + x](int row) { return rows[row] + offset; };
            };
            const FloatsPair y = filteredEven(filters.achromatic, at(kY));
            const FloatsPair cx = filteredEven(filters.redGreen, at(kCx));
            const FloatsPair wide = filteredEven(filters.blueYellowWide, at(kCzWide));
            const FloatsPair narrow = filteredEven(filters.blueYellowNarrow, at(kCzNarrow));
            const FloatsPair edgeX = filteredEven(filters.smooth, at(kEdge));
            const FloatsPair edgeY = filteredOdd(filters.edge, at(kSmooth));
            const FloatsPair pointX = filteredEven(filters.smooth, at(kPoint));
            const FloatsPair pointY = filteredEven(filters.point, at(kSmooth));
            low[i] = {{y.low, cx.low, wide.low + narrow.low},
                      lengthOf(edgeX.low, edgeY.low),
                      lengthOf(pointX.low, pointY.low)};
            high[i] = {{y.high, cx.high, wide.high + narrow.high},
                       lengthOf(edgeX.high, edgeY.high),
                       lengthOf(pointX.high, pointY.high)};
        }
        storeFloats(errors_.data() + x, flipError(task.colors, low[0], low[1]));
        storeFloats(errors_.data() + x + kLanes, flipError(task.colors, high[0], high[1]));
    }
}

inline void FlipTile::fill(const FlipTask& task, int x0, int y0) {
    const int width = static_cast<int>(task.pictures[0]->width);
    const int endY = std::min(y0 + kFlipTileHeight, static_cast<int>(task.pictures[0]->height));
    const int used = std::min(kFlipTileWidth, width - x0), columns = (used + kStep - 1) / kStep * kStep;
    const int radius = task.filters.radius, ringRows = 2 * radius + 1;
    for (int y = y0 - radius; y < endY + radius; ++y) {
        const int age = y - (y0 - radius);
        for (int i = 0; i < 2; ++i) {
            float* const lines = lines_[i].data() + static_cast<std::size_t>(age % ringRows) * kRowFloats;
            loadRow(task, *task.pictures[i], x0, y);
            filterAlongX(task.filters, columns, lines);
        }
        const int row = y - radius; // whose neighbours are complete now
        if (row < y0) continue;
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < ringRows; ++k)
                rows_[i][static_cast<std::size_t>(k)] =
                    lines_[i].data() + static_cast<std::size_t>((row - y0 + k) % ringRows) * kRowFloats;
        filterAlongY(task, columns);
        float* const to = task.errors.data() + static_cast<std::size_t>(row) * task.pictures[0]->width + x0;
        for (int x = 0; x < used; ++x) to[x] = std::max(to[x], errors_[static_cast<std::size_t>(x)]);
    }
}

RT_WIDE_LANES void FlipTile::run(const FlipTask& task, int x0, int y0) {
    resize(task.filters);
    fill(task, x0, y0);
}

} // namespace rt
