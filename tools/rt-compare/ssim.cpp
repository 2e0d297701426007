#include "tools/rt-compare/ssim.h"

#include "common/wide_lanes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {
namespace {

constexpr std::size_t kWindow = 11, kMargin = kWindow / 2;
constexpr double kDeviation = 1.5;                                            // pixels
constexpr double kLuminanceGuard = 0.01 * 0.01, kContrastGuard = 0.03 * 0.03; // (K L)^2 for L = 1
constexpr std::size_t kRowsPerBlock = 32;
constexpr std::array<double, 5> kScaleWeights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

using Window = std::array<double, kWindow>;

Window gaussianWindow() {
    Window window;
    double sum = 0.0;
    for (std::size_t i = 0; i < kWindow; ++i) {
        const double x = double(i) - double(kMargin);
        sum += window[i] = std::exp(-x * x / (2.0 * kDeviation * kDeviation));
    }
    for (double& weight : window) weight /= sum;
    return window;
}

// The five products whose local means SSIM is made of.
enum Product { kA, kB, kAa, kBb, kAb, kProducts };

// Local means of the products for one row of windows after the other.
class WindowRows {
public:
    explicit WindowRows(const SsimPlanes& planes)
        : planes_(planes), columns_(planes.width - (kWindow - 1)), products_(kProducts * planes.width),
          ring_(kWindow * kProducts * columns_), ssim_(columns_), contrast_(columns_) {}

    // Of the windows whose first row is y. Rows must come one after the other.
    void advanceTo(std::size_t y) {
        const std::size_t from = isStarted_ ? y + kWindow - 1 : y;
        for (std::size_t row = from; row < y + kWindow; ++row) filterAlongX(row);
        isStarted_ = true;
        filterAlongY(y);
    }

    std::span<const double> ssim() const { return ssim_; }
    std::span<const double> contrast() const { return contrast_; } // contrast times structure

private:
    RT_WIDE_LANES void filterAlongX(std::size_t row);
    RT_WIDE_LANES void filterAlongY(std::size_t y);
    double* ringRow(std::size_t row) { return ring_.data() + row % kWindow * kProducts * columns_; }

    const SsimPlanes& planes_;
    const Window window_ = gaussianWindow();
    std::size_t columns_;
    std::vector<double> products_, ring_, ssim_, contrast_;
    bool isStarted_ = false;
};

void WindowRows::filterAlongX(std::size_t row) {
    const std::size_t width = planes_.width;
    const float* const a = planes_.a.data() + row * width;
    const float* const b = planes_.b.data() + row * width;
    double* const p = products_.data();
    for (std::size_t x = 0; x < width; ++x) {
        const double va = a[x], vb = b[x];
        p[kA * width + x] = va;
        p[kB * width + x] = vb;
        p[kAa * width + x] = va * va;
        p[kBb * width + x] = vb * vb;
        p[kAb * width + x] = va * vb;
    }
    for (std::size_t product = 0; product < kProducts; ++product) {
        double* const to = ringRow(row) + product * columns_;
        std::fill(to, to + columns_, 0.0);
        for (std::size_t k = 0; k < kWindow; ++k)
            for (std::size_t x = 0; x < columns_; ++x) to[x] += window_[k] * p[product * width + x + k];
    }
}

void WindowRows::filterAlongY(std::size_t y) {
    std::vector<double>& means = products_; // its row was used up
    means.assign(kProducts * planes_.width, 0.0);
    for (std::size_t k = 0; k < kWindow; ++k) {
        const double* const row = ringRow(y + k);
        for (std::size_t i = 0; i < kProducts * columns_; ++i) means[i] += window_[k] * row[i];
    }
    const double *const ma = means.data(), *const mb = ma + columns_;
    const double *const maa = mb + columns_, *const mbb = maa + columns_, *const mab = mbb + columns_;
    for (std::size_t x = 0; x < columns_; ++x) {
        const double aa = ma[x] * ma[x], bb = mb[x] * mb[x], ab = ma[x] * mb[x];
        const double variances = (maa[x] - aa) + (mbb[x] - bb), covariance = mab[x] - ab;
        contrast_[x] = (2.0 * covariance + kContrastGuard) / (variances + kContrastGuard);
        ssim_[x] = contrast_[x] * (2.0 * ab + kLuminanceGuard) / (aa + bb + kLuminanceGuard);
    }
}

struct SsimSums {
    double ssim = 0.0, contrast = 0.0;
    std::size_t windows = 0;
};

// Adds a row's windows whose middle counts.
void addRow(const SsimPlanes& planes, std::size_t y, const WindowRows& rows, SsimSums& sums) {
    const std::size_t middles = (y + kMargin) * planes.width + kMargin;
    for (std::size_t x = 0; x < rows.ssim().size(); ++x) {
        if (!planes.ignored.empty() && planes.ignored[middles + x]) continue;
        sums.ssim += rows.ssim()[x];
        sums.contrast += rows.contrast()[x];
        ++sums.windows;
    }
}

// Calls work(block, y, rows) for each row of windows, blocks of them side by side.
template <class Work>
void forEachRow(const SsimPlanes& planes, Work&& work) {
    const std::size_t rowCount = planes.height - (kWindow - 1);
    tbb::parallel_for(std::size_t(0), (rowCount + kRowsPerBlock - 1) / kRowsPerBlock, [&](std::size_t block) {
        WindowRows rows(planes);
        const std::size_t end = std::min(rowCount, (block + 1) * kRowsPerBlock);
        for (std::size_t y = block * kRowsPerBlock; y < end; ++y) {
            rows.advanceTo(y);
            work(block, y, rows);
        }
    });
}

// Fills the rows of the map whose windows these are; pixels at the edges have those of the nearest window.
void fillMap(const SsimPlanes& planes, std::size_t y, const WindowRows& rows, std::span<float> map) {
    const std::size_t first = y == 0 ? 0 : y + kMargin;
    const std::size_t end = y == planes.height - kWindow ? planes.height : y + kMargin + 1;
    for (std::size_t row = first; row < end; ++row)
        for (std::size_t x = 0; x < planes.width; ++x) {
            const std::size_t column = std::clamp(x, kMargin, planes.width - 1 - kMargin) - kMargin;
            map[row * planes.width + x] = static_cast<float>(rows.ssim()[column]);
        }
}

// The means over all windows: added block by block, in the same order for any number of threads. Fills the
// map unless it is empty.
SsimSums meansOf(const SsimPlanes& planes, std::span<float> map = {}) {
    std::vector<SsimSums> blocks(planes.height / kRowsPerBlock + 1);
    forEachRow(planes, [&](std::size_t block, std::size_t y, const WindowRows& rows) {
        addRow(planes, y, rows, blocks[block]);
        if (!map.empty()) fillMap(planes, y, rows, map);
    });
    SsimSums all;
    for (const SsimSums& block : blocks) {
        all.ssim += block.ssim;
        all.contrast += block.contrast;
        all.windows += block.windows;
    }
    if (all.windows == 0) return {1.0, 1.0, 0};
    const auto count = static_cast<double>(all.windows);
    return {all.ssim / count, all.contrast / count, all.windows};
}

// Half as wide and high: means of 2x2 pixels; an odd row or column at the end is left out.
struct HalvedPlanes {
    std::vector<float> a, b;
    std::vector<std::uint8_t> ignored;
    SsimPlanes view;

    explicit HalvedPlanes(const SsimPlanes& from) {
        const std::uint32_t width = from.width / 2, height = from.height / 2;
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const std::size_t i = 2 * y * from.width + 2 * x, below = i + from.width;
                const auto mean = [&](std::span<const float> p) {
                    return (p[i] + p[i + 1] + p[below] + p[below + 1]) * 0.25f;
                };
                a.push_back(mean(from.a));
                b.push_back(mean(from.b));
                const auto& m = from.ignored;
                if (!m.empty()) ignored.push_back(m[i] & m[i + 1] & m[below] & m[below + 1]);
            }
        view = {width, height, a, b, ignored};
    }
};

// `means` are those of the planes themselves.
double multiScale(const SsimPlanes& planes, SsimSums means) {
    double product = 1.0;
    std::optional<HalvedPlanes> halved;
    for (std::size_t scale = 0; scale < kScaleWeights.size(); ++scale) {
        if (scale > 0) {
            halved.emplace(HalvedPlanes(halved ? halved->view : planes));
            means = meansOf(halved->view);
        }
        const bool isLast = scale + 1 == kScaleWeights.size();
        // Negative means (one picture is rather the negative of the other) have no such power: no similarity.
        product *= std::pow(std::max(isLast ? means.ssim : means.contrast, 0.0), kScaleWeights[scale]);
    }
    return product;
}

} // namespace

SsimFigures measureSsim(const SsimPlanes& planes, const SsimWants& wants) {
    SsimFigures figures;
    if (wants.map) figures.map.assign(std::size_t(planes.width) * planes.height, 1.0f);
    const std::uint32_t least = std::min(planes.width, planes.height);
    if (least < kSsimLeast) return figures;
    const SsimSums means = meansOf(planes, figures.map);
    if (wants.single) figures.single = means.ssim;
    if (wants.multi && least >= kMsSsimLeast) figures.multi = multiScale(planes, means);
    return figures;
}

} // namespace rt
