#include "tools/rt-grid/clip_triangle.h"

#include <algorithm>

namespace rt {

std::pair<double, double> ClippedTriangle::extentAlong(int axis) const {
    double lo = corners_[0][axis], hi = lo;
    for (std::size_t i = 1; i < count_; ++i) {
        lo = std::min(lo, corners_[i][axis]);
        hi = std::max(hi, corners_[i][axis]);
    }
    return {lo, hi};
}

ClippedTriangle ClippedTriangle::between(int axis, double lo, double hi) const {
    const auto [least, most] = extentAlong(axis);
    if (least > hi || most < lo) return {};
    if (least >= lo && most <= hi) return *this;
    const ClippedTriangle above = least >= lo ? *this : beyond(axis, lo, 1.0);
    return most <= hi || above.empty() ? above : above.beyond(axis, hi, -1.0);
}

ClippedTriangle ClippedTriangle::beyond(int axis, double bound, double side) const {
    ClippedTriangle part;
    const auto keep = [&](const glm::dvec3& corner) { part.corners_[part.count_++] = corner; };
    for (std::size_t i = 0; i < count_; ++i) {
        const glm::dvec3& a = corners_[i];
        const glm::dvec3& b = corners_[i + 1 == count_ ? 0 : i + 1];
        const double heightA = side * (a[axis] - bound);
        const double heightB = side * (b[axis] - bound);
        if (heightA >= 0.0) keep(a);
        if ((heightA < 0.0) == (heightB < 0.0)) continue;
        glm::dvec3 crossing = a + (b - a) * (heightA / (heightA - heightB));
        crossing[axis] = bound;
        keep(crossing);
    }
    return part;
}

} // namespace rt
