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

Vec Facets::choose(const Vec& view, Random& random) const {
    const Vec stretched = glm::normalize(Vec(view.x * alpha, view.y * alpha, view.z));
    const double around = 2.0 * kPi * random.unit();
    const double z = (1.0 - random.unit()) * (1.0 + stretched.z) - stretched.z;
    const double across = std::sqrt(std::max(1.0 - z * z, 0.0));
    const Vec h = Vec(across * std::cos(around), across * std::sin(around), z) + stretched;
    return glm::normalize(Vec(h.x * alpha, h.y * alpha, std::max(h.z, 1e-9)));
}

double Facets::unhidden(const Vec& view, const Vec& light) const {
    return light.z > 0.0 ? (1.0 + lambda(view)) / (1.0 + lambda(view) + lambda(light)) : 0.0;
}

} // namespace rt::reference
