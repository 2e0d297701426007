#pragma once
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>

namespace rt::test {

/// SplitMix64 (Steele, Lea & Flood 2014): the n-th number of a stream without the ones before it.
inline std::uint64_t hashOf(std::uint64_t n) {
    n += 0x9E3779B97F4A7C15u;
    n = (n ^ (n >> 30)) * 0xBF58476D1CE4E5B9u;
    n = (n ^ (n >> 27)) * 0x94D049BB133111EBu;
    return n ^ (n >> 31);
}

/// The random numbers of one ray, from its number alone: the same whichever thread makes the ray.
class RayNumbers {
public:
    RayNumbers(std::uint64_t seed, std::uint64_t ray) : state_(hashOf(hashOf(seed) + ray)) {}

    std::uint64_t bits() { return hashOf(state_++); }
    /// Below `count`, which is at most 2^32.
    std::size_t index(std::size_t count) { return (bits() >> 32) * count >> 32; }
    /// In [0, 1).
    float unit() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
    float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
    /// In the unit cube.
    glm::vec3 point() {
        const float x = unit();
        const float y = unit();
        return {x, y, unit()};
    }
    /// In the cube from -1 to 1, and not zero.
    glm::vec3 direction() {
        const glm::vec3 d = point() * 2.0f - 1.0f;
        return d == glm::vec3(0.0f) ? glm::vec3(1.0f, 0.0f, 0.0f) : d;
    }

private:
    std::uint64_t state_;
};

} // namespace rt::test
