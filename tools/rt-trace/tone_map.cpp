#include "tools/rt-trace/tone_map.h"

#include "formats/image.h"

#include <glm/common.hpp>

namespace rt {
namespace {

constexpr double kHableWhite = 11.2;
constexpr double kHableExposure = 2.0;

glm::dvec3 hable(const glm::dvec3& x) {
    constexpr double a = 0.15, b = 0.5, c = 0.1, d = 0.2, e = 0.02, f = 0.3;
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

glm::dvec3 aces(const glm::dvec3& x) {
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

} // namespace

double luminanceOf(const glm::dvec3& linear) {
    return luminanceOf(linear.r, linear.g, linear.b);
}

glm::dvec3 toneMapped(ToneMap map, const glm::dvec3& linear) {
    switch (map) {
    case ToneMap::Reinhard:
        return linear / (1.0 + luminanceOf(linear));
    case ToneMap::Aces:
        return aces(linear);
    case ToneMap::Filmic:
        return hable(kHableExposure * linear) / hable(glm::dvec3(kHableWhite));
    case ToneMap::None:
        break;
    }
    return linear;
}

} // namespace rt
