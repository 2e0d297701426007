#include "tools/rt-compare/flip.h"

#include "tools/rt-compare/flip_tile.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

constexpr double kToneMappedLevel =
    0.85;                            // at which automatic exposures put the brightest pixel and the median
constexpr float kDarkest = 0x1p-32f; // of a bright pixel; what is darker has no say in exposures
constexpr unsigned kMostExposures = 33;
constexpr double kLeastShown = 1e-3, kMostShown = 16.0; // that the tone map makes neither black nor white

class FlipRun {
public:
    FlipRun(const ColorPlanes& reference, const ColorPlanes& test, double pixelsPerDegree)
        : errors_(reference.pixelCount()), task_{{&reference, &test},
                                                 makeFlipFilters(pixelsPerDegree),
                                                 {},
                                                 {},
                                                 errors_} {}

    void expose(std::optional<float> factor) {
        const int width = static_cast<int>(task_.pictures[0]->width);
        const int columns = (width + kFlipTileWidth - 1) / kFlipTileWidth;
        const int height = static_cast<int>(task_.pictures[0]->height);
        const int rows = (height + kFlipTileHeight - 1) / kFlipTileHeight;
        task_.exposure = factor;
        tbb::parallel_for(0, columns * rows, [&](int tile) {
            tiles_.local().run(task_, tile % columns * kFlipTileWidth, tile / columns * kFlipTileHeight);
        });
    }

    std::vector<float> take() { return std::move(errors_); }

private:
    std::vector<float> errors_;
    FlipTask task_;
    tbb::enumerable_thread_specific<FlipTile> tiles_;
};

// Luminances above 0 that are finite.
std::vector<float> luminancesOf(const ColorPlanes& picture) {
    std::vector<float> luminances(picture.pixelCount());
    const auto [r, g, b] = picture.planes;
    for (std::size_t i = 0; i < luminances.size(); ++i) {
        const float y = 0.2126f * r[i] + 0.7152f * g[i] + 0.0722f * b[i];
        luminances[i] = std::isfinite(y) ? std::max(y, 0.0f) : 0.0f;
    }
    return luminances;
}

float medianOf(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// A bright pixel's luminance: exceeded by a thousandth of those above 0, and by one of them if there are
// several. A few pixels without measure do not make all others dark.
float brightOf(std::vector<float> luminances) {
    std::erase(luminances, 0.0f);
    const std::size_t exceeding = std::max<std::size_t>(luminances.size() / 1000, 1);
    const auto place =
        luminances.end() - static_cast<std::ptrdiff_t>(std::min(luminances.size(), exceeding + 1));
    std::nth_element(luminances.begin(), place, luminances.end());
    return *place;
}

// The value that the tone map takes to kToneMappedLevel: root of a quadratic equation.
double valueAtLevel() {
    const double a = kAcesAbove[2] - kToneMappedLevel * kAcesBelow[2];
    const double b = kAcesAbove[1] - kToneMappedLevel * kAcesBelow[1];
    const double c = kAcesAbove[0] - kToneMappedLevel * kAcesBelow[0];
    return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

} // namespace

double ExposureRange::factor(unsigned i) const {
    return std::exp2(count < 2 ? start : start + (stop - start) * i / (count - 1));
}

std::vector<float> flipLdr(const ColorPlanes& reference, const ColorPlanes& test, double pixelsPerDegree) {
    FlipRun run(reference, test, pixelsPerDegree);
    run.expose(std::nullopt);
    return run.take();
}

std::vector<float> flipHdr(const ColorPlanes& reference, const ColorPlanes& test,
                           const ExposureRange& exposures, double pixelsPerDegree) {
    FlipRun run(reference, test, pixelsPerDegree);
    for (unsigned i = 0; i < exposures.count; ++i) run.expose(static_cast<float>(exposures.factor(i)));
    return run.take();
}

AutomaticExposures automaticExposures(const ColorPlanes& reference, const ColorPlanes& test) {
    AutomaticExposures result;
    for (const ColorPlanes* const picture : {&reference, &test}) {
        std::vector<float> luminances = luminancesOf(*picture);
        const float brightest = *std::max_element(luminances.begin(), luminances.end());
        if (brightest == 0.0f) {
            result.note = "the reference is black; exposures are those of the other picture";
            continue;
        }
        const float darkest = brightOf(luminances) * kDarkest;
        float median = medianOf(luminances);
        if (median <= darkest) {
            result.note += result.note.empty() ? "" : "; ";
            result.note += "most pixels are black; exposures are those of the others";
            std::erase_if(luminances, [&](float y) { return y <= darkest; });
            median = medianOf(luminances);
        }
        const double level = valueAtLevel();
        ExposureRange& range = result.range;
        range = {std::log2(level / brightest), std::log2(level / median), 1};
        if (range.stop > range.start)
            range.count =
                std::clamp(static_cast<unsigned>(std::ceil(range.stop - range.start)), 2u, kMostExposures);
        return result;
    }
    result.note = "both pictures are black; the exposure is 0";
    return result;
}

bool showsAnything(const ColorPlanes& picture, const ExposureRange& exposures) {
    const std::vector<float> luminances = luminancesOf(picture);
    for (unsigned i = 0; i < exposures.count; ++i) {
        const double factor = exposures.factor(i);
        if (std::ranges::any_of(
                luminances, [&](float y) { return factor * y >= kLeastShown && factor * y <= kMostShown; }))
            return true;
    }
    return false;
}

} // namespace rt
