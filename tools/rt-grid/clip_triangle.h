#pragma once
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <utility>

namespace rt {

/// A triangle, or what clipping has left of one. Every corner is a point of the triangle but for rounding, so
/// a part that is left proves that the triangle is there.
class ClippedTriangle {
public:
    ClippedTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) : count_(3) {
        corners_[0] = a;
        corners_[1] = b;
        corners_[2] = c;
    }

    bool empty() const { return count_ == 0; }
    /// The least and largest coordinate of a part that is not empty.
    std::pair<double, double> extentAlong(int axis) const;
    /// The part between two planes across an axis (Sutherland & Hodgman 1974).
    ClippedTriangle between(int axis, double lo, double hi) const;

private:
    static constexpr std::size_t kMostCorners = 9; // each of six planes adds one at most
    ClippedTriangle() = default;
    /// The part on the side of a plane where side * coordinate is at least side * bound.
    ClippedTriangle beyond(int axis, double bound, double side) const;

    std::array<glm::dvec3, kMostCorners> corners_;
    std::size_t count_ = 0;
};

} // namespace rt
