#include "tests/reference/optics.h"

#include <algorithm>
#include <cmath>

namespace rt::reference {

double fresnel(double cosine, double n1, double n2) {
    const double angle = std::acos(std::min(cosine, 1.0));
    const double sine = std::sin(angle) * n1 / n2;
    if (sine >= 1.0) return 1.0;
    const double beyond = std::asin(sine);
    const double a = n1 * std::cos(angle), b = n2 * std::cos(beyond);
    const double c = n1 * std::cos(beyond), d = n2 * std::cos(angle);
    const double s = (a - b) / (a + b), p = (c - d) / (c + d);
    return 0.5 * (s * s + p * p);
}

Vec metalReflectance(double cosine, const Vec& color) {
    return color + (1.0 - color) * std::pow(1.0 - cosine, 5.0);
}

Vec turnedTo(const Vec& n, const Vec& local) {
    const Vec other = std::abs(n.x) < 0.7 ? Vec(1, 0, 0) : Vec(0, 1, 0);
    const Vec x = glm::normalize(glm::cross(other, n)), y = glm::cross(n, x);
    return x * local.x + y * local.y + n * local.z;
}

double Facets::density(const Vec& h) const {
    if (h.z <= 0.0) return 0.0;
    const double tangent2 = (h.x * h.x + h.y * h.y) / (h.z * h.z), a2 = alpha * alpha;
    return a2 / (kPi * std::pow(h.z, 4.0) * std::pow(a2 + tangent2, 2.0));
}

double Facets::lambda(const Vec& w) const {
    const double tangent2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0) / 2.0;
}

double Facets::lobe(const Vec& view, const Vec& light) const {
    if (view.z <= 0.0 || light.z <= 0.0) return 0.0;
    return density(glm::normalize(view + light)) / (1.0 + lambda(view) + lambda(light)) / (4.0 * view.z);
}

Vec Facets::choose(Random& random) const {
    const double u = random.unit();
    const double polar = std::atan(alpha * std::sqrt(u / (1.0 - u))), around = 2.0 * kPi * random.unit();
    return {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
}

double Facets::seen(const Vec& view, const Vec& h) const {
    const double facing = glm::dot(view, h);
    return facing > 0.0 ? facing / ((1.0 + lambda(view)) * view.z * h.z) : 0.0;
}

double Facets::unhidden(const Vec& view, const Vec& light) const {
    return light.z > 0.0 ? (1.0 + lambda(view)) / (1.0 + lambda(view) + lambda(light)) : 0.0;
}

} // namespace rt::reference
