#pragma once
#include "tools/rt-compare/limits.h"
#include "tools/rt-compare/metrics.h"
#include "tools/rt-compare/noise_test.h"
#include "tools/rt-compare/pair_result.h"

#include <vector>

namespace rt {

/// How to compare, as the command line says it.
struct CompareOptions : PairOptions {
    MetricOptions metrics;
    NoiseOptions noise;
    PerceptionOptions perception;
    std::vector<Limit> limits;
    bool allowSameNonFinite = false;
    int maxShift = 8; ///< pixels in which the alignment is looked for; 0: not at all
};

/// Pictures that help to compare two others; nullptr: none.
struct SidePictures {
    const Picture* mask = nullptr;   ///< see regionOf()
    const Picture* second = nullptr; ///< what the reference shows, rendered with another seed
};

/// All that can be said about two pictures. A pass needs: the same structure (parts, size, channels, ...), no
/// value that is not finite, no black picture against another one, every limit kept and, where it is asked
/// for, no difference beyond the noise. Same input, same bits, on any number of threads. Throws
/// Error{InvalidContent} if a side picture does not fit.
PairResult comparePictures(Picture&& a, Picture&& b, const CompareOptions& options,
                           const SidePictures& side = {});

} // namespace rt
