#include "tools/rt-compare/ssim_pyramid.h"

#include "common/wide_lanes.h"
#include "tools/rt-compare/float_lanes.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rt {
namespace {

constexpr std::size_t kRowsPerBlock = 32; // a multiple of 2 to the power of the smaller levels

// Not a multiple of large powers of 2: pixels below each other would share few lines of the cache.
std::size_t strideOf(std::size_t width) {
    constexpr std::size_t kLine = 16; // of 64 bytes
    return ((width + kLine - 1) / kLine | 1) * kLine;
}

// sRGB(v / (1 + v)).
inline Floats displayOf(const Floats& linear) {
    const Floats none = allFloats(0.0f);
    Floats v = greater(linear - linear == 0.0f ? linear : none, none);
    v = v / (1.0f + v);
    const Floats curve = 1.055f * power(v, allFloats(1.0f / 2.4f)) - 0.055f;
    return v <= 0.0031308f ? 12.92f * v : curve;
}

RT_WIDE_LANES void addAndSubtract(const float* a, const float* b, std::size_t count, bool isLinear,
                                  float* sum, float* difference) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const std::size_t some = std::min(kLanes, count - i);
        Floats va = some == kLanes ? loadFloats(a + i) : loadFloats(a + i, some);
        Floats vb = some == kLanes ? loadFloats(b + i) : loadFloats(b + i, some);
        if (isLinear) {
            va = displayOf(va);
            vb = displayOf(vb);
        }
        const Floats added = va + vb - 1.0f, subtracted = va - vb;
        std::memcpy(sum + i, &added, some * sizeof(float));
        std::memcpy(difference + i, &subtracted, some * sizeof(float));
    }
}

// A row of means of 2x2 values.
RT_WIDE_LANES void halve(const float* above, const float* below, std::size_t count, float* to) {
    for (std::size_t x = 0; x < count; ++x)
        to[x] = ((above[2 * x] + above[2 * x + 1]) + (below[2 * x] + below[2 * x + 1])) * 0.25f;
}

void halveRows(const SsimLevel& from, std::size_t first, std::size_t end, SsimLevel& to) {
    for (std::size_t y = first; y < end; ++y) {
        const std::size_t above = 2 * y * from.stride, below = above + from.stride, row = y * to.stride;
        for (const auto plane : {&SsimLevel::sum, &SsimLevel::difference})
            halve((from.*plane).data() + above, (from.*plane).data() + below, to.width,
                  (to.*plane).data() + row);
    }
}

// 1 where all four pixels are ignored.
std::vector<std::uint8_t> halvedMask(const SsimLevel& from) {
    std::vector<std::uint8_t> mask;
    for (std::size_t y = 0; y < from.height / 2; ++y)
        for (std::size_t x = 0; x < from.width / 2; ++x) {
            const std::uint8_t* const m = from.ignored.data() + 2 * (y * from.width + x);
            mask.push_back(m[0] & m[1] & m[from.width] & m[from.width + 1]);
        }
    return mask;
}

} // namespace

void SsimPyramid::resize(const SsimPlanes& planes, std::size_t levels) {
    levels_.resize(levels);
    ignored_.resize(levels);
    for (std::size_t i = 0; i < levels; ++i) {
        SsimLevel& level = levels_[i];
        level.width = planes.width >> i;
        level.height = planes.height >> i;
        level.stride = strideOf(level.width);
        level.sum.resize(level.stride * level.height + kSlack);
        level.difference.resize(level.sum.size());
        level.ignored = planes.ignored;
        if (i == 0 || planes.ignored.empty()) continue;
        ignored_[i] = halvedMask(levels_[i - 1]);
        level.ignored = ignored_[i];
    }
}

// Of all levels, those that come of kRowsPerBlock rows of the planes.
void SsimPyramid::fillRows(const SsimPlanes& planes, std::size_t firstRow) {
    const std::size_t endRow = std::min<std::size_t>(firstRow + kRowsPerBlock, planes.height);
    SsimLevel& whole = levels_[0];
    for (std::size_t y = firstRow; y < endRow; ++y)
        addAndSubtract(planes.a.data() + y * whole.width, planes.b.data() + y * whole.width, whole.width,
                       planes.isLinear, whole.sum.data() + y * whole.stride,
                       whole.difference.data() + y * whole.stride);
    for (std::size_t i = 1; i < levels_.size(); ++i)
        halveRows(levels_[i - 1], firstRow >> i, endRow >> i, levels_[i]);
}

void SsimPyramid::build(const SsimPlanes& planes, std::size_t levels) {
    resize(planes, levels);
    tbb::parallel_for(std::size_t(0), (planes.height + kRowsPerBlock - 1) / kRowsPerBlock,
                      [&](std::size_t block) { fillRows(planes, block * kRowsPerBlock); });
}

} // namespace rt
