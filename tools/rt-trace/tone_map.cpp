#include "tools/rt-trace/tone_map.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

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
    return glm::dot(linear, glm::dvec3(0.2126, 0.7152, 0.0722));
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

glm::dvec3 heatColor(double t) {
    static constexpr std::array<std::array<unsigned char, 3>, 9> kColors = {{{68, 1, 84},
                                                                             {71, 45, 123},
                                                                             {59, 82, 139},
                                                                             {44, 114, 142},
                                                                             {33, 145, 140},
                                                                             {40, 174, 128},
                                                                             {94, 201, 98},
                                                                             {173, 220, 48},
                                                                             {253, 231, 37}}};
    const double place = std::clamp(std::isfinite(t) ? t : 0.0, 0.0, 1.0) * (kColors.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), kColors.size() - 2);
    const auto color = [](const std::array<unsigned char, 3>& c) {
        return glm::dvec3(c[0], c[1], c[2]) / 255.0;
    };
    return glm::mix(color(kColors[k]), color(kColors[k + 1]), place - static_cast<double>(k));
}

} // namespace rt
