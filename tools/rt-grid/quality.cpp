#include "tools/rt-grid/quality.h"

#include <array>

namespace rt {

double QualityPreset::voxelsPerTriangle(std::uint32_t structure) const {
    return std::array{uniformVoxelsPerTriangle, cloudVoxelsPerTriangle, octantVoxelsPerTriangle,
                      nestedVoxelsPerTriangle}[structure];
}

QualityPreset presetOf(Quality quality) {
    NestOptions nest; // balanced
    switch (quality) {
    case Quality::fast:
        nest.wordCost = 0.02;
        nest.exitReach = 0;
        return {2.0, 8.0, 8.0, 0.2, nest};
    case Quality::best:
        nest.wordCost = 0.002;
        nest.leafSize = 8;
        nest.exitReach = 5;
        return {8.0, 64.0, 64.0, 0.5, nest};
    case Quality::balanced:
        break;
    }
    return {4.0, 16.0, 16.0, 0.2, nest};
}

} // namespace rt
