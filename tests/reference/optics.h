#pragma once
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <random>

namespace rt::reference {

using Vec = glm::dvec3;

inline constexpr double kPi = 3.14159265358979323846;

/// Random numbers without any order, in [0, 1).
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double unit() { return distribution_(engine_); }

private:
    std::mt19937_64 engine_;
    std::uniform_real_distribution<double> distribution_{0.0, 1.0};
};

/// Part of unpolarized light that a smooth border between media of index n1 (where the light comes from) and
/// n2 reflects. Source: Fresnel's equations, Born & Wolf, 1.5.2.
double fresnel(double cosine, double n1, double n2);

/// Source: Schlick 1994.
Vec metalReflectance(double cosine, const Vec& color);

/// A direction of unit length along or about `n`: x and y across it.
Vec turnedTo(const Vec& n, const Vec& local);

/// Facets about +z by GGX: Walter et al. 2007, masked after Smith with correlated heights (Heitz 2014).
struct Facets {
    double alpha = 0.0;

    double density(const Vec& h) const;
    double lambda(const Vec& w) const;
    /// Reflected towards `view` of light of radiance 1 and solid angle 1 from `light`, before Fresnel.
    double lobe(const Vec& view, const Vec& light) const;
    /// A normal, chosen as often as it is seen from `view` (Dupuy & Benyoub 2023: reflect a cap of the
    /// sphere).
    Vec choose(const Vec& view, Random& random) const;
    /// Of light that a facet reflects to `view`, the part that others let arrive, from `light`.
    double unhidden(const Vec& view, const Vec& light) const;
};

} // namespace rt::reference
