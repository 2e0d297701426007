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
        return {.uniformVoxelsPerTriangle = 2.0,
                .cloudVoxelsPerTriangle = 8.0,
                .octantVoxelsPerTriangle = 8.0,
                .nestedVoxelsPerTriangle = 0.2,
                .nest = nest};
    case Quality::best:
        nest.wordCost = 0.002;
        nest.leafSize = 8;
        nest.exitReach = 5;
        return {.uniformVoxelsPerTriangle = 8.0,
                .cloudVoxelsPerTriangle = 64.0,
                .octantVoxelsPerTriangle = 64.0,
                .nestedVoxelsPerTriangle = 0.5,
                .nest = nest};
    case Quality::balanced:
        break;
    }
    return {.uniformVoxelsPerTriangle = 4.0,
            .cloudVoxelsPerTriangle = 16.0,
            .octantVoxelsPerTriangle = 16.0,
            .nestedVoxelsPerTriangle = 0.2,
            .nest = nest};
}

} // namespace rt
