#include "formats/heat_color.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt {

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
