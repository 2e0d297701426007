#pragma once
#include "tools/rt-trace/film.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/render.h"
#include "tools/rt-trace/tile_samples.h"

#include <functional>

namespace rt {

/// When a render loop ends before every tile has its samples, and what it does on the way.
struct LoopControl {
    double targetError = 0.0; ///< of the mean, relative: tiles that are better get no more samples; 0 = off
    double endMs = 0.0;       ///< programMs() at which to end, once every pixel has a sample; 0 = never
    std::uint64_t mostSamples = std::uint64_t(1) << 30; ///< of a dispatch, all pixels together; for tests
    /// Saves what there is, of which this run took so many milliseconds on the device; called now and then,
    /// and before the program ends because of a signal.
    std::function<void(double gpuMs)> save = {};
};

struct LoopFigures {
    double gpuMs = 0.0; ///< of all dispatches
    std::uint32_t dispatches = 0;
    std::uint64_t samples = 0; ///< of all pixels together, taken in this run
    bool timeLimitReached = false;
    std::size_t tilesStopped = 0; ///< because their error was small enough
};

/// Renders the samples that `tiles` lack into `film`, both bound and current. Cuts the work so that no
/// dispatch takes long, whatever the scene and the device. The picture does not depend on the cuts: each
/// pixel's samples are added up in their order. A signal ends the program after the running dispatch.
LoopFigures renderTiles(const GpuPrograms& programs, GpuView& view, const Film& film,
                        const GlContext& context, TileSamples& tiles, const LoopControl& control);

/// Mean over a tile's pixels of the standard error of a pixel's mean luminance, relative to it, or to 0.01
/// where it is darker. `moments`: sums of the luminance squared and of the luminance over `samples` >= 2.
double meanRelativeError(std::span<const glm::vec2> moments, std::uint32_t samples);

} // namespace rt
