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

// What a row becomes along y; along x each goes on through its own filters.
enum Line { kY, kCx, kCzWide, kCzNarrow, kSmooth, kEdge, kPoint, kLineCount };

struct FloatsPair {
    Floats low, high; // of kStep columns
};

inline FloatsPair loadPair(const float* from) {
    return {loadFloats(from), loadFloats(from + kLanes)};
}
inline void storePair(float* to, const FloatsPair& values) {
    storeFloats(to, values.low);
    storeFloats(to + kLanes, values.high);
}
inline FloatsPair operator+(const FloatsPair& a, const FloatsPair& b) {
    return {a.low + b.low, a.high + b.high};
}
inline FloatsPair operator-(const FloatsPair& a, const FloatsPair& b) {
    return {a.low - b.low, a.high - b.high};
}
inline FloatsPair operator*(float weight, const FloatsPair& a) {
    return {weight * a.low, weight * a.high};
}
inline void operator+=(FloatsPair& sum, const FloatsPair& a) {
    sum.low += a.low;
    sum.high += a.high;
}

// The sum over at(-radius) ... at(radius), pointers to kStep values each. Here as below the small weights
// come first, which loses the fewest digits.
template <class At>
inline FloatsPair filtered(const LineFilter& filter, At&& at) {
    const float* const weights = filter.weights.data();
    FloatsPair sum{};
    for (int i = filter.radius(); i > 0; --i) sum += weights[i] * (loadPair(at(i)) + loadPair(at(-i)));
    return sum + weights[0] * loadPair(at(0));
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
    radius_ = filters.radius;
    stride_ = (kFlipTileWidth + 2 * radius_ + kStep - 1) / kStep * kStep;
    const auto stride = static_cast<std::size_t>(stride_),
               ringRows = static_cast<std::size_t>(2 * radius_ + 1);
    errors_.resize(kFlipTileWidth);
    for (int i = 0; i < 2; ++i) {
        rows_[i].resize(ringRows * 3 * stride);
        near_[i].resize(ringRows);
        lines_[i].resize(kLineCount * stride);
    }
}

// Whether the pictures have the same bits wherever errors of the tile come from.
bool FlipTile::isEqual(const FlipTask& task, int x0, int y0, int endX, int endY) const {
    const ColorPlanes &a = *task.pictures[0], &b = *task.pictures[1];
    const int left = std::max(x0 - radius_, 0), right = std::min(endX + radius_, static_cast<int>(a.width));
    const int top = std::max(y0 - radius_, 0), bottom = std::min(endY + radius_, static_cast<int>(a.height));
    for (int y = top; y < bottom; ++y)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = static_cast<std::size_t>(y) * a.width + static_cast<std::size_t>(left);
            if (std::memcmp(a.planes[c].data() + at, b.planes[c].data() + at,
                            static_cast<std::size_t>(right - left) * sizeof(float)) != 0)
                return false;
        }
    return true;
}

inline void toOpponents(const FlipTask& task, ColorPlanes::Encoding encoding, float* row, int stride) {
    const Floats none = allFloats(0.0f), bright = allFloats(1e6f); // the tone map's end is far below
    float* const r = row;
    float* const g = r + stride;
    float* const b = g + stride;
    for (int x = 0; x < stride; x += kLaneCount) {
        Floats rgb[3] = {loadFloats(r + x), loadFloats(g + x), loadFloats(b + x)};
        for (Floats& v : rgb) {
            v = v - v == 0.0f ? v : none;
            if (task.exposure) v = acesToneMapped(greater(lesser(v * *task.exposure, bright), none));
            v = clampToUnit(v);
            if (encoding == ColorPlanes::Encoding::Srgb) v = decodedSrgb(v);
        }
        const FloatsTriple opponent = opponentOf(task.colors, {rgb[0], rgb[1], rgb[2]});
        storeFloats(r + x, opponent.x);
        storeFloats(g + x, opponent.y);
        storeFloats(b + x, opponent.z);
    }
}

// The picture goes on beyond its edges as at them.
inline void FlipTile::loadRow(const FlipTask& task, const ColorPlanes& picture, int x0, int y,
                              float* to) const {
    const int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    const int left = x0 - radius_, first = std::max(left, 0), end = std::min(left + stride_, width);
    const std::size_t row = static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * picture.width;
    for (std::size_t c = 0; c < 3; ++c) {
        const float* const from = picture.planes[c].data() + row;
        float* const plane = to + c * static_cast<std::size_t>(stride_);
        std::fill(plane, plane + (first - left), from[first]);
        std::copy(from + first, from + end, plane + (first - left));
        std::fill(plane + (end - left), plane + stride_, from[end - 1]);
    }
    toOpponents(task, picture.encoding, to, stride_);
}

// The filters of a channel share what they read.
inline void FlipTile::filterAlongY(const FlipFilters& filters, int picture, int columns) {
    const float* const* const rows = near_[picture].data() + radius_;
    const auto weightsOf = [](const LineFilter& filter) { return filter.weights.data(); };
    const float *const seen = weightsOf(filters.achromatic), *const smooth = weightsOf(filters.smooth),
                       *const edge = weightsOf(filters.edge), *const point = weightsOf(filters.point),
                       *const wide = weightsOf(filters.blueYellowWide),
                       *const narrow = weightsOf(filters.blueYellowNarrow);
    const int seenRadius = filters.achromatic.radius(), featureRadius = filters.smooth.radius();
    for (int x = 0; x < columns; x += kStep) {
        const auto at = [&](int row, int channel) { return loadPair(rows[row] + channel * stride_ + x); };
        const auto put = [&](Line line, const FloatsPair& values) {
            storePair(lines_[picture].data() + line * stride_ + x, values);
        };
        const FloatsPair y = at(0, 0);
        FloatsPair seenSum{}, smoothSum{}, edgeSum{}, pointSum{};
        for (int i = seenRadius; i > featureRadius; --i) seenSum += seen[i] * (at(i, 0) + at(-i, 0));
        for (int i = featureRadius; i > 0; --i) {
            const FloatsPair below = at(i, 0), above = at(-i, 0), both = below + above;
            if (i <= seenRadius) seenSum += seen[i] * both;
            smoothSum += smooth[i] * both;
            edgeSum += edge[i] * (below - above);
            pointSum += point[i] * both;
        }
        const FloatsPair cz = at(0, 2);
        FloatsPair wideSum{}, narrowSum{};
        for (int i = filters.blueYellowWide.radius(); i > 0; --i) {
            const FloatsPair both = at(i, 2) + at(-i, 2);
            wideSum += wide[i] * both;
            narrowSum += narrow[i] * both;
        }
        put(kY, seenSum + seen[0] * y);
        put(kSmooth, smoothSum + smooth[0] * y);
        put(kEdge, edgeSum);
        put(kPoint, pointSum + point[0] * y);
        put(kCx, filtered(filters.redGreen, [&](int row) { return rows[row] + stride_ + x; }));
        put(kCzWide, wideSum + wide[0] * cz);
        put(kCzNarrow, narrowSum + narrow[0] * cz);
    }
}

inline void FlipTile::filterAlongX(const FlipTask& task, int columns) {
    const FlipFilters& filters = task.filters;
    const float *const edge = filters.edge.weights.data(), *const point = filters.point.weights.data();
    for (int x = 0; x < columns; x += kStep) {
        Seen low[2], high[2];
        for (int i = 0; i < 2; ++i) {
            const auto at = [from = lines_[i].data() + radius_ + x, stride = stride_](Line line) {
                return [line = from + line * stride](int column) { return line + column; };
            };
            const FloatsPair y = filtered(filters.achromatic, at(kY));
            const FloatsPair cx = filtered(filters.redGreen, at(kCx));
            const FloatsPair cz = filtered(filters.blueYellowWide, at(kCzWide)) +
                                  filtered(filters.blueYellowNarrow, at(kCzNarrow));
            const FloatsPair edgeY = filtered(filters.smooth, at(kEdge));
            const FloatsPair pointY = filtered(filters.smooth, at(kPoint));
            const auto smooth = at(kSmooth);
            FloatsPair edgeX{}, pointX{};
            for (int k = filters.edge.radius(); k > 0; --k) {
                const FloatsPair after = loadPair(smooth(k)), before = loadPair(smooth(-k));
                edgeX += edge[k] * (after - before);
                pointX += point[k] * (after + before);
            }
            pointX += point[0] * loadPair(smooth(0));
            low[i] = {
                {y.low, cx.low, cz.low}, lengthOf(edgeX.low, edgeY.low), lengthOf(pointX.low, pointY.low)};
            high[i] = {{y.high, cx.high, cz.high},
                       lengthOf(edgeX.high, edgeY.high),
                       lengthOf(pointX.high, pointY.high)};
        }
        storeFloats(errors_.data() + x, flipError(task.colors, low[0], low[1]));
        storeFloats(errors_.data() + x + kLanes, flipError(task.colors, high[0], high[1]));
    }
}

inline void FlipTile::fill(const FlipTask& task, int x0, int y0, int columns, int endY) {
    const int ringRows = 2 * radius_ + 1, padded = (columns + kStep - 1) / kStep * kStep;
    const auto rowOf = [&](int picture, int age) {
        return rows_[picture].data() + static_cast<std::size_t>(age % ringRows * 3 * stride_);
    };
    for (int y = y0 - radius_; y < endY + radius_; ++y) {
        const int age = y - (y0 - radius_);
        for (int i = 0; i < 2; ++i) loadRow(task, *task.pictures[i], x0, y, rowOf(i, age));
        const int row = y - radius_; // whose neighbours are complete now
        if (row < y0) continue;
        for (int i = 0; i < 2; ++i) {
            for (int k = 0; k < ringRows; ++k) near_[i][static_cast<std::size_t>(k)] = rowOf(i, row - y0 + k);
            filterAlongY(task.filters, i, padded + 2 * radius_);
        }
        filterAlongX(task, padded);
        float* const to = task.errors.data() + static_cast<std::size_t>(row) * task.pictures[0]->width + x0;
        const float* const found = errors_.data();
        for (int x = 0; x < columns; ++x) to[x] = std::max(to[x], found[x]);
    }
}

RT_WIDE_LANES void FlipTile::run(const FlipTask& task, int x0, int y0) {
    const int endX = std::min(x0 + kFlipTileWidth, static_cast<int>(task.pictures[0]->width));
    const int endY = std::min(y0 + kFlipTileHeight, static_cast<int>(task.pictures[0]->height));
    resize(task.filters);
    if (!isEqual(task, x0, y0, endX, endY)) fill(task, x0, y0, endX - x0, endY);
}

} // namespace rt
