#include "tools/rt-compare/noise_test.h"

#include "tools/rt-compare/noise_stages.h"

namespace rt {

NoiseTest testNoise(const PreparedPair& pair, const NoiseOptions& options, const Picture* second) {
    NoiseTest result;
    result.level = options.level;
    testPixelNoise(pair, options.level / 2.0, second, result);
    testRegionNoise(pair, options.level / 2.0, result);
    return result;
}

} // namespace rt
