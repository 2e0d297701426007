#include "tools/rt-grid/shrink_image.h"

#include "formats/image.h"

#include "formats/material.shared.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

namespace rt {
namespace {

// The sRGB code of linear light and back, by tables: 2^26 texels would be three times as many powers.
class SrgbTables {
public:
    SrgbTables() {
        for (unsigned code = 0; code < 256; ++code) {
            linear_[code] = static_cast<float>(decodeSrgb(code / 255.0));
            // Code k is nearest from here on; the last is never reached.
            border_[code] = code == 0 ? 0.0f : static_cast<float>(decodeSrgb((code - 0.5) / 255.0));
        }
        unsigned code = 0;
        for (unsigned bin = 0; bin < kBins; ++bin) {
            const float lowest = static_cast<float>(bin) / kBins;
            while (code < 255 && border_[code + 1] <= lowest) ++code;
            start_[bin] = static_cast<std::uint8_t>(code);
        }
    }

    float linear(std::uint32_t code) const { return linear_[code]; }

    std::uint32_t code(float linear) const {
        const auto bin = static_cast<std::size_t>(std::clamp(linear, 0.0f, 1.0f) * kBins);
        std::uint32_t code = start_[std::min<std::size_t>(bin, kBins - 1)];
        while (code < 255 && border_[code + 1] <= linear) ++code;
        return code;
    }

private:
    static constexpr unsigned kBins = 4096; // so narrow that each holds two codes at most
    std::array<float, 256> linear_;
    std::array<float, 256> border_;
    std::array<std::uint8_t, kBins> start_;
};

const SrgbTables& srgbTables() {
    static const SrgbTables tables;
    return tables;
}

// Which texels of a side one of the next level covers, and with what share of it.
struct Taps {
    std::uint32_t first;
    std::uint32_t count; // 1 to 3
    std::array<float, 3> weight;
};

// Texel i of `to` covers [i * from, (i + 1) * from) where one of `from` is `to` long.
Taps tapsOf(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    const std::uint64_t begin = std::uint64_t(i) * from, end = begin + from;
    Taps taps{static_cast<std::uint32_t>(begin / to), 0, {}};
    for (std::uint64_t lo = std::uint64_t(taps.first) * to; lo < end; lo += to) {
        const std::uint64_t covered = std::min(end, lo + to) - std::max(begin, lo);
        taps.weight[taps.count++] = static_cast<float>(covered) / static_cast<float>(from);
    }
    return taps;
}

vec4 channels(std::uint32_t texel) {
    return {texel & 255u, texel >> 8 & 255u, texel >> 16 & 255u, texel >> 24};
}

std::uint32_t rounded(float value) {
    return static_cast<std::uint32_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
}

template <class Visit>
void visitTaps(const TexelBlock& from, const Taps& across, const Taps& down, Visit&& visit) {
    for (std::uint32_t y = 0; y < down.count; ++y) {
        const std::uint32_t* row = from.first + (down.first + y) * from.stride + across.first;
        for (std::uint32_t x = 0; x < across.count; ++x) visit(row[x], across.weight[x] * down.weight[y]);
    }
}

std::uint32_t meanOfNumbers(const TexelBlock& from, const Taps& across, const Taps& down) {
    vec4 sum(0.0f);
    visitTaps(from, across, down, [&](std::uint32_t texel, float w) { sum += w * channels(texel); });
    return rounded(sum.x) | rounded(sum.y) << 8 | rounded(sum.z) << 16 | rounded(sum.w) << 24;
}

std::uint32_t meanOfColors(const TexelBlock& from, const Taps& across, const Taps& down) {
    const SrgbTables& srgb = srgbTables();
    vec4 seen(0.0f); // rgb weighted by alpha; alpha
    vec3 all(0.0f);
    visitTaps(from, across, down, [&](std::uint32_t texel, float w) {
        const vec3 color(srgb.linear(texel & 255u), srgb.linear(texel >> 8 & 255u),
                         srgb.linear(texel >> 16 & 255u));
        const float alpha = static_cast<float>(texel >> 24);
        all += w * color;
        seen += w * alpha * vec4(color, 1.0f);
    });
    const vec3 color = seen.w > 0.0f ? vec3(seen) / seen.w : all;
    return srgb.code(color.x) | srgb.code(color.y) << 8 | srgb.code(color.z) << 16 | rounded(seen.w) << 24;
}

} // namespace

void shrinkImage(const TexelBlock& from, const TexelBlock& to, std::uint32_t space) {
    std::vector<Taps> across(to.size.x);
    for (std::uint32_t x = 0; x < to.size.x; ++x) across[x] = tapsOf(x, from.size.x, to.size.x);
    const auto mean = space == kImageLinear ? meanOfNumbers : meanOfColors;
    tbb::parallel_for(std::uint32_t(0), to.size.y, [&](std::uint32_t y) {
        const Taps down = tapsOf(y, from.size.y, to.size.y);
        for (std::uint32_t x = 0; x < to.size.x; ++x)
            to.first[y * to.stride + x] = mean(from, across[x], down);
    });
}

} // namespace rt
