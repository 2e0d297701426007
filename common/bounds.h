#pragma once
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace rt {

/// Axis-aligned box; empty (lo > hi) until a point is added.
template <class T>
struct BoundsOf {
    using Vec = glm::vec<3, T>;
    Vec lo{std::numeric_limits<T>::max()};
    Vec hi{std::numeric_limits<T>::lowest()};

    Vec extent() const { return hi - lo; }
    Vec centre() const { return lo + (hi - lo) * T(0.5); }
    void add(const Vec& point) {
        lo = glm::min(lo, point);
        hi = glm::max(hi, point);
    }
};

using Bounds = BoundsOf<float>;
using BoundsD = BoundsOf<double>;

} // namespace rt
