#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <utility>

namespace rt {

/// A triangle in voxel coordinates: voxel (x, y, z) is the cube from (x, y, z) to (x+1, y+1, z+1).
using VoxelTriangle = std::array<glm::dvec3, 3>;

namespace voxelize {

/// The least whole number that is not below `value`, the largest that is not above it: std::ceil and
/// std::floor for absolute values up to 2^30, which is quicker.
inline int wholeAbove(double value) {
    const auto whole = static_cast<int>(value);
    return whole + (whole < value);
}
inline int wholeBelow(double value) {
    const auto whole = static_cast<int>(value);
    return whole - (whole > value);
}

/// Whole indices from lo to hi, both included; none if lo > hi.
struct Indices {
    int lo;
    int hi;
};

/// Indices from lo to hi, both included and not yet rounded to whole ones; none if lo > hi.
struct Range {
    double lo;
    double hi;

    Range(const Indices& whole) : lo(whole.lo), hi(whole.hi) {}
    /// Of a range that is not empty, in a range of whole indices.
    Indices whole() const { return {wholeAbove(lo), wholeBelow(hi)}; }
};

/// The condition lo <= slope * index + others <= hi, solved for the index. Any condition that the padded
/// voxels of a triangle meet is sound, so rounded slopes lose nothing.
class Slope {
public:
    Slope(double slope, double lo, double hi)
        : inverse_(slope == 0.0 ? kSteep : 1.0 / slope), lo_(lo), hi_(hi) {
        if (slope < 0.0) std::swap(lo_, hi_);
    }
    /// Keeps the part of `range` that meets the condition.
    void narrow(Range& range, double others) const {
        range.lo = std::max(range.lo, (lo_ - others) * inverse_);
        range.hi = std::min(range.hi, (hi_ - others) * inverse_);
    }

private:
    // Stands for 1 / 0: makes the bounds all or nothing, as `others` meets the condition or not.
    static constexpr double kSteep = 0x1p900;
    double inverse_;
    double lo_, hi_; // exchanged where the slope is negative
};

/// A separating axis as a condition on a voxel's index: the triangle's and the padded voxel's shadows on the
/// axis overlap if and only if lo <= dot(normal, index) <= hi.
struct Shadow {
    double lo;
    double hi;

    // A normal of 0 has to let everything pass, hence 2^-100.
    Shadow(double a, double b, double middle, double radius)
        : lo(std::min(a, b) - middle - (radius + 0x1p-100)),
          hi(std::max(a, b) - middle + (radius + 0x1p-100)) {}
};

/// The axis across an edge and one coordinate axis: one of the 2D test of the triangle's and the voxel's
/// projections to the plane of the axes u and v.
struct EdgeAxis {
    double normalU;
    double normalV;
    Shadow shadow;

    EdgeAxis(const VoxelTriangle& t, int edge, int u, int v, double pad)
        : EdgeAxis(t[static_cast<std::size_t>(edge)], t[static_cast<std::size_t>((edge + 1) % 3)],
                   t[static_cast<std::size_t>((edge + 2) % 3)], u, v, pad) {}
    Slope alongU() const { return {normalU, shadow.lo, shadow.hi}; }
    Slope alongV() const { return {normalV, shadow.lo, shadow.hi}; }

private:
    EdgeAxis(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& opposite, int u, int v,
             double pad)
        : normalU(to[v] - from[v]), normalV(from[u] - to[u]),
          shadow(normalU * from[u] + normalV * from[v], normalU * opposite[u] + normalV * opposite[v],
                 0.5 * (normalU + normalV), (0.5 + pad) * (std::abs(normalU) + std::abs(normalV))) {}
};

/// The three edges' conditions on (u, v): solved for u, with what v adds to each.
class EdgeSlopes {
public:
    EdgeSlopes(const VoxelTriangle& t, int u, int v, double pad)
        : EdgeSlopes(EdgeAxis(t, 0, u, v, pad), EdgeAxis(t, 1, u, v, pad), EdgeAxis(t, 2, u, v, pad)) {}
    void narrow(Range& range, double atV) const {
        for (std::size_t i = 0; i < 3; ++i) slopes_[i].narrow(range, normalV_[i] * atV);
    }

private:
    EdgeSlopes(const EdgeAxis& a, const EdgeAxis& b, const EdgeAxis& c)
        : slopes_{a.alongU(), b.alongU(), c.alongU()}, normalV_{a.normalV, b.normalV, c.normalV} {}
    std::array<Slope, 3> slopes_;
    std::array<double, 3> normalV_;
};

/// Indices along `axis` of the voxels, in an endless grid, whose padded extent meets the triangle's. Far ones
/// are as good as at 2^30.
inline Indices indicesAlong(const VoxelTriangle& t, int axis, double pad) {
    constexpr double kFar = 0x1p30;
    return {wholeAbove(std::clamp(std::min({t[0][axis], t[1][axis], t[2][axis]}) - pad - 1.0, -kFar, kFar)),
            wholeBelow(std::clamp(std::max({t[0][axis], t[1][axis], t[2][axis]}) + pad, -kFar, kFar))};
}

inline int longestComponent(const glm::dvec3& v) {
    const glm::dvec3 a(std::abs(v.x), std::abs(v.y), std::abs(v.z));
    return a.z >= a.x && a.z >= a.y ? 2 : a.y >= a.x ? 1 : 0;
}

/// A triangle, and the voxels that its bounds meet, with the axes turned so that a given one comes last.
struct Turned {
    int u, v, w; ///< where the axes 0, 1 and 2 were
    VoxelTriangle t;
    std::array<Indices, 3> box;

    Turned(const VoxelTriangle& triangle, const std::array<Indices, 3>& indices, int last)
        : u((last + 1) % 3), v((last + 2) % 3),
          w(last), t{turn(triangle[0]), turn(triangle[1]), turn(triangle[2])},
          box{indices[static_cast<std::size_t>(u)], indices[static_cast<std::size_t>(v)],
              indices[static_cast<std::size_t>(w)]} {}

    glm::dvec3 turn(const glm::dvec3& p) const { return {p[u], p[v], p[w]}; }
    template <class Visit>
    void visitIndex(int atU, int atV, int atW, Visit&& visit) const {
        glm::uvec3 index;
        index[u] = static_cast<unsigned>(atU);
        index[v] = static_cast<unsigned>(atV);
        index[w] = static_cast<unsigned>(atW);
        visit(index);
    }
};

/// The part of forEachVoxelOf() for triangles that one layer of voxels across axis 2 holds: in it the
/// projections along that axis decide.
template <class Visit>
void visitLayer(const Turned& turned, double pad, Visit&& visit) {
    const EdgeSlopes edges(turned.t, 0, 1, pad);
    const auto& [boxU, boxV, boxW] = turned.box;
    for (int atV = boxV.lo; atV <= boxV.hi; ++atV) {
        Range columns = boxU;
        edges.narrow(columns, atV);
        if (columns.lo > columns.hi) continue;
        const Indices whole = columns.whole();
        for (int atU = whole.lo; atU <= whole.hi; ++atU) turned.visitIndex(atU, atV, boxW.lo, visit);
    }
}

/// The part of forEachVoxelOf() for triangles that no layer of voxels holds; they face axis 2. Each of the 13
/// conditions is linear in the index, so they are solved for one axis after the other instead of being tried
/// voxel by voxel: rows along v, columns (u, v) of a row, voxels along w of a column.
template <class Visit>
void visitOverlaps(const Turned& turned, const glm::dvec3& normal, double pad, Visit&& visit) {
    const VoxelTriangle& t = turned.t;
    const double d0 = glm::dot(normal, t[0]); // all three: a sliver's normal is mostly rounding
    const double d1 = glm::dot(normal, t[1]);
    const double d2 = glm::dot(normal, t[2]);
    const Shadow plane(std::min({d0, d1, d2}), std::max({d0, d1, d2}), 0.5 * (normal.x + normal.y + normal.z),
                       (0.5 + pad) * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)));
    const Slope planeAlongW(normal.z, plane.lo, plane.hi);
    const EdgeSlopes uv(t, 0, 1, pad);
    const EdgeSlopes wv(t, 2, 1, pad);
    const EdgeSlopes wu(t, 2, 0, pad);
    const auto& [boxU, boxV, boxW] = turned.box;
    for (int atV = boxV.lo; atV <= boxV.hi; ++atV) {
        Range columns = boxU;
        uv.narrow(columns, atV);
        Range rowDepths = boxW;
        wv.narrow(rowDepths, atV);
        if (rowDepths.lo > rowDepths.hi || columns.lo > columns.hi) continue;
        const Indices wholeColumns = columns.whole();
        for (int atU = wholeColumns.lo; atU <= wholeColumns.hi; ++atU) {
            Range depths = rowDepths;
            planeAlongW.narrow(depths, normal.x * atU + normal.y * atV);
            wu.narrow(depths, atU);
            if (depths.lo > depths.hi) continue;
            const Indices whole = depths.whole();
            for (int atW = whole.lo; atW <= whole.hi; ++atW) turned.visitIndex(atU, atV, atW, visit);
        }
    }
}

} // namespace voxelize

/// Calls visit(glm::uvec3 index) once for each voxel of a grid of `dims` voxels whose cube, grown by `pad` on
/// every side, meets the triangle. Exact but for rounding of about 1e-15 * dims voxels, which the pad
/// swallows: a voxel that the triangle enters is never missed. Triangles may be degenerate (a segment, a
/// point) but must be finite. Source: the separating axes of Akenine-Moller 2001, evaluated by columns as in
/// Schwarz & Seidel 2010.
template <class Visit>
void forEachVoxelOf(const VoxelTriangle& triangle, const glm::uvec3& dims, double pad, Visit&& visit) {
    using namespace voxelize;
    std::array<Indices, 3> box;
    int longAxes = 0;
    int shortAxis = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const Indices whole = indicesAlong(triangle, axis, pad);
        const bool isLong = whole.lo < whole.hi;
        longAxes += isLong;
        if (!isLong) shortAxis = axis;
        box[axis] = {std::max(whole.lo, 0), std::min(whole.hi, static_cast<int>(dims[axis]) - 1)};
        if (box[axis].lo > box[axis].hi) return;
    }
    if (longAxes == 3) {
        const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
        const Turned turned(triangle, box, longestComponent(normal));
        return visitOverlaps(turned, turned.turn(normal), pad, visit);
    }
    if (longAxes == 2) return visitLayer(Turned(triangle, box, shortAxis), pad, visit);
    for (int z = box[2].lo; z <= box[2].hi; ++z) // inside one row: every voxel between its ends
        for (int y = box[1].lo; y <= box[1].hi; ++y)
            for (int x = box[0].lo; x <= box[0].hi; ++x) visit(glm::uvec3(x, y, z));
}

} // namespace rt
