#pragma once
#include <cstring>

namespace rt {

/// Eight floats that go through the same arithmetic at once, and the integers of their comparisons and bits.
/// The functions here are element-wise and use nothing but IEEE operations: the same bits on every processor.
using Floats = float __attribute__((vector_size(32)));
using Ints = int __attribute__((vector_size(32)));
inline constexpr std::size_t kLanes = 8;
/// Four doubles, for sums of floats.
using Doubles = double __attribute__((vector_size(32)));
inline constexpr std::size_t kDoubleLanes = 4;

inline Floats allFloats(float value) {
    return Floats{value, value, value, value, value, value, value, value};
}
inline Floats loadFloats(const float* from) {
    Floats values;
    std::memcpy(&values, from, sizeof values);
    return values;
}
inline void storeFloats(float* to, const Floats& values) {
    std::memcpy(to, &values, sizeof values);
}
/// The first `count`, the others 0.
inline Floats loadFloats(const float* from, std::size_t count) {
    Floats values{};
    std::memcpy(&values, from, count * sizeof(float));
    return values;
}
inline Doubles loadDoubles(const float* from) {
    float __attribute__((vector_size(16))) values;
    std::memcpy(&values, from, sizeof values);
    return __builtin_convertvector(values, Doubles);
}
inline double sumOf(const Doubles& lanes) {
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}
/// b where a is NaN.
inline Floats lesser(const Floats& a, const Floats& b) {
    return a < b ? a : b;
}
inline Floats greater(const Floats& a, const Floats& b) {
    return a > b ? a : b;
}
inline Floats clampToUnit(const Floats& a) {
    return greater(lesser(a, allFloats(1.0f)), allFloats(0.0f));
}

inline Ints bitsOf(const Floats& a) {
    Ints bits;
    std::memcpy(&bits, &a, sizeof bits);
    return bits;
}
inline Floats floatsOf(const Ints& bits) {
    Floats values;
    std::memcpy(&values, &bits, sizeof values);
    return values;
}

inline Floats absolute(const Floats& a) {
    return floatsOf(bitsOf(a) & 0x7fffffff);
}

/// For +0 and normal numbers, within 3e-7 of the value: Newton's method from the halved exponent.
inline Floats squareRoot(const Floats& a) {
    Floats inverse = floatsOf(0x5f3759df - (bitsOf(a) >> 1));
    for (int i = 0; i < 3; ++i) inverse = inverse * (1.5f - 0.5f * a * inverse * inverse);
    return a * inverse;
}

/// For numbers from 1e-9 to 1e9, within 3e-7 of the value: Halley's method from a third of the exponent.
inline Floats cubeRoot(const Floats& a) {
    const Floats third = __builtin_convertvector(bitsOf(a), Floats) * (1.0f / 3.0f) + float(0x2a514067);
    Floats root = floatsOf(__builtin_convertvector(third, Ints));
    for (int i = 0; i < 2; ++i) {
        const Floats cube = root * root * root;
        root = root * (cube + 2.0f * a) / (2.0f * cube + a);
    }
    return root;
}

/// For normal numbers > 0, within 2e-7: the exponent, and a series in (m - 1) / (m + 1) for the rest.
inline Floats log2Of(const Floats& a) {
    constexpr int kSqrtHalf = 0x3f3504f3;
    const Ints shifted = bitsOf(a) - kSqrtHalf;
    const Ints exponent = shifted >> 23;
    const Floats mantissa = floatsOf((shifted & 0x007fffff) + kSqrtHalf);
    const Floats s = (mantissa - 1.0f) / (mantissa + 1.0f), t = s * s;
    const Floats series =
        (1.0f + t * (1.0f / 3)) + t * t * ((1.0f / 5 + t * (1.0f / 7)) + t * t * (1.0f / 9));
    return __builtin_convertvector(exponent, Floats) + 2.8853901f * s * series; // 2 / ln 2
}

/// For numbers from -126 to 126, within 3e-7 of the value.
inline Floats exp2Of(const Floats& a) {
    const Floats shifted = a + 0x1.8p23f; // has the whole number in its lowest bits
    const Ints whole = bitsOf(shifted) - 0x4b400000;
    const Floats x = (a - (shifted - 0x1.8p23f)) * 0.69314718f, t = x * x;
    const Floats low = (1.0f + x) + t * (1.0f / 2 + x * (1.0f / 6));
    const Floats series = low + t * t * ((1.0f / 24 + x * (1.0f / 120)) + t * (1.0f / 720));
    return floatsOf(bitsOf(series) + (whole << 23));
}

/// For a >= 0 (below 1e-30 it counts as 0, for which this is 0 too) and exponents from 0.01 to 4.
inline Floats power(const Floats& a, const Floats& exponent) {
    const Floats least = allFloats(1e-30f);
    const Floats value = exp2Of(greater(exponent * log2Of(greater(a, least)), allFloats(-126.0f)));
    return a <= least ? allFloats(0.0f) : value;
}

} // namespace rt
