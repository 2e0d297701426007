// FLIP, HDR-FLIP and SSIM of 1920x1080 pixels: wall and processor time of one evaluation, files not read.
#include "tools/rt-compare/flip.h"
#include "tools/rt-compare/pool_errors.h"
#include "tools/rt-compare/ssim.h"

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <thread>

namespace rt {
namespace {

constexpr std::uint32_t kWidth = 1920, kHeight = 1080;

struct Pair {
    std::vector<float> a[3], b[3];

    explicit Pair(double brightest) {
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
                const double x = i % kWidth, y = double(i / kWidth);
                const double value =
                    brightest * std::pow(0.5 + 0.5 * std::sin(0.07 * x * (c + 1) + 0.03 * y), 4.0);
                a[c].push_back(static_cast<float>(value));
                b[c].push_back(static_cast<float>(value * (1.0 + 0.1 * std::sin(0.0013 * x * y))));
            }
    }
    ColorPlanes planesA(ColorPlanes::Encoding encoding) const {
        return {kWidth, kHeight, {a[0], a[1], a[2]}, encoding};
    }
    ColorPlanes planesB(ColorPlanes::Encoding encoding) const {
        return {kWidth, kHeight, {b[0], b[1], b[2]}, encoding};
    }
};

void limitThreads(benchmark::State& state, const std::function<void()>& work) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
    for (auto _ : state) work();
}

void ldrFlip(benchmark::State& state) {
    const Pair pair(1.0);
    const auto encoding = ColorPlanes::Encoding::Srgb;
    limitThreads(state, [&] {
        benchmark::DoNotOptimize(poolErrors(flipLdr(pair.planesA(encoding), pair.planesB(encoding))));
    });
}

void hdrFlip14Exposures(benchmark::State& state) {
    const Pair pair(50.0);
    const auto encoding = ColorPlanes::Encoding::Linear;
    limitThreads(state, [&] {
        benchmark::DoNotOptimize(
            poolErrors(flipHdr(pair.planesA(encoding), pair.planesB(encoding), {-12.5, 1.0, 14})));
    });
}

void ssimOfOneChannel(benchmark::State& state) {
    const Pair pair(1.0);
    limitThreads(state, [&] {
        benchmark::DoNotOptimize(
            measureSsim({kWidth, kHeight, pair.a[0], pair.b[0], {}, false}, {.single = true}));
    });
}

int allCores() {
    return static_cast<int>(std::thread::hardware_concurrency());
}

#define RT_PERCEPTION_BENCHMARK(function)                                                                    \
    BENCHMARK(function)                                                                                      \
        ->Arg(1)                                                                                             \
        ->Arg(2)                                                                                             \
        ->Arg(allCores())                                                                                    \
        ->MeasureProcessCPUTime()                                                                            \
        ->UseRealTime()                                                                                      \
        ->Unit(benchmark::kMillisecond)
RT_PERCEPTION_BENCHMARK(ldrFlip);
RT_PERCEPTION_BENCHMARK(hdrFlip14Exposures);
RT_PERCEPTION_BENCHMARK(ssimOfOneChannel);

} // namespace
} // namespace rt

BENCHMARK_MAIN();
