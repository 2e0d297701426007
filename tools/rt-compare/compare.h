#pragma once
#include "tools/rt-compare/limits.h"
#include "tools/rt-compare/metrics.h"
#include "tools/rt-compare/noise_test.h"
#include "tools/rt-compare/perception.h"

#include <set>
#include <string>
#include <vector>

namespace rt {

struct CompareOptions {
    MetricOptions metrics;
    FocusOptions focus;
    NoiseOptions noise;
    PerceptionOptions perception;
    std::vector<Limit> limits;
    std::set<std::string> allowed; ///< of kAllowable
    bool allowSameNonFinite = false;
    int maxShift = 8; ///< pixels in which the alignment is looked for; 0: not at all
};

struct ComparedPair {
    PreparedPair pair;
    Comparison comparison;
    std::vector<PerceptionMaps> maps; ///< of the layers
};

/// All that can be said about two pictures. A pass needs: the same structure (parts, size, channels, ...), no
/// value that is not finite, no black picture against another one, every limit kept and, where it is asked
/// for, no difference beyond the noise. Same input, same bits, on any number of threads. Throws
/// Error{InvalidContent} if the mask or the second render of options does not fit.
ComparedPair comparePictures(Picture&& a, Picture&& b, const CompareOptions& options);

} // namespace rt
