#pragma once
#include "common/wide_lanes.h"

#include <cstddef>
#include <cstring>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace rt {

/// Four doubles that go through the same arithmetic at once: the compiler's vector type, which each
/// architecture has instructions for or the compiler takes apart.
using Lanes = double __attribute__((vector_size(32)));
using IntLanes = int __attribute__((vector_size(16)));
using BitLanes = long __attribute__((vector_size(32))); ///< what comparisons of Lanes give, 0 or -1, too

/// For every type with members of these: code for wide registers expects them where such registers load from,
/// but the type alone has that alignment only where the whole program is compiled for them.
#define RT_LANES_ALIGNED alignas(sizeof(::rt::Lanes))

struct RT_LANES_ALIGNED LanesTriple {
    Lanes lanes[3];
    const Lanes& operator[](std::size_t i) const { return lanes[i]; }
    Lanes& operator[](std::size_t i) { return lanes[i]; }
};

inline Lanes allLanes(double value) {
    return Lanes{value, value, value, value};
}
inline Lanes lanesOf(const glm::dvec3& v, double last = 0.0) {
    return Lanes{v.x, v.y, v.z, last};
}
/// x, y, z and 0: w may hold other bits than a number's.
inline Lanes lanesOf(const glm::vec4& v) {
    using FloatLanes = float __attribute__((vector_size(16)));
    FloatLanes all;
    std::memcpy(&all, &v, sizeof all);
    return __builtin_convertvector(__builtin_shufflevector(all, FloatLanes{}, 0, 1, 2, 7), Lanes);
}
inline Lanes lesser(const Lanes& a, const Lanes& b) {
    return a < b ? a : b;
}
inline Lanes greater(const Lanes& a, const Lanes& b) {
    return a > b ? a : b;
}
inline Lanes absolute(const Lanes& a) {
    return greater(a, -a);
}
inline Lanes withLast(const Lanes& a, double last) {
    return __builtin_shufflevector(a, allLanes(last), 0, 1, 2, 7);
}
inline IntLanes lesser(const IntLanes& a, const IntLanes& b) {
    return a < b ? a : b;
}
inline IntLanes greater(const IntLanes& a, const IntLanes& b) {
    return a > b ? a : b;
}
/// The least whole numbers that are not below the values, which std::ceil gives too: absolute values up to
/// 2^30 only, but quicker.
inline IntLanes wholeAbove(const Lanes& a) {
    constexpr double kOnlyWhole = 0x3p51; // sums with it have no digits after the point
    const Lanes nearest = (a + kOnlyWhole) - kOnlyWhole;
    return __builtin_convertvector(nearest + (nearest < a ? allLanes(1.0) : allLanes(0.0)), IntLanes);
}

} // namespace rt
