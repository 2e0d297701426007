#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace rt {

/// A triangle in voxel coordinates: voxel (x, y, z) is the cube from (x, y, z) to (x+1, y+1, z+1).
using VoxelTriangle = std::array<glm::dvec3, 3>;

namespace voxelize {

/// Whole numbers lo to hi, both included; none if lo > hi.
struct Range {
    double lo;
    double hi;
};

/// One separating axis as a condition on a voxel's index: the triangle's and the padded voxel's shadows on
/// the axis overlap if and only if lo <= dot(normal, index) <= hi. Any normal is sound, so a rounded one
/// loses nothing.
class Axis {
public:
    Axis(const VoxelTriangle& triangle, const glm::dvec3& normal, double pad) : normal_(normal) {
        const double d0 = glm::dot(normal, triangle[0]);
        const double d1 = glm::dot(normal, triangle[1]);
        const double d2 = glm::dot(normal, triangle[2]);
        const double middle = 0.5 * (normal.x + normal.y + normal.z);
        const double radius = (0.5 + pad) * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
        lo_ = std::min({d0, d1, d2}) - middle - radius;
        hi_ = std::max({d0, d1, d2}) - middle + radius;
    }
    /// Keeps the part of `range`, indices along `axis`, that meets the condition; `others` is the share of
    /// dot(normal, index) that the other axes have.
    void narrow(Range& range, int axis, double others) const {
        const double slope = normal_[axis];
        if (slope == 0.0) {
            if (others < lo_ || others > hi_) range.hi = range.lo - 1.0;
            return;
        }
        const double a = (lo_ - others) / slope;
        const double b = (hi_ - others) / slope;
        range.lo = std::max(range.lo, std::ceil(std::min(a, b)));
        range.hi = std::min(range.hi, std::floor(std::max(a, b)));
    }
    const glm::dvec3& normal() const { return normal_; }

private:
    glm::dvec3 normal_;
    double lo_;
    double hi_;
};

/// The three axes across edges and one coordinate axis: the 2D test of the triangle's and the voxel's
/// projections.
inline std::array<Axis, 3> axesAcrossEdges(const VoxelTriangle& t, int u, int v, double pad) {
    const auto across = [&](const glm::dvec3& from, const glm::dvec3& to) {
        glm::dvec3 normal(0.0);
        normal[u] = to[v] - from[v];
        normal[v] = from[u] - to[u];
        return Axis(t, normal, pad);
    };
    return {across(t[0], t[1]), across(t[1], t[2]), across(t[2], t[0])};
}

/// Indices along `axis` of the voxels, in an endless grid, whose padded extent meets the triangle's.
inline Range indexRange(const VoxelTriangle& t, int axis, double pad) {
    return {std::ceil(std::min({t[0][axis], t[1][axis], t[2][axis]}) - pad - 1.0),
            std::floor(std::max({t[0][axis], t[1][axis], t[2][axis]}) + pad)};
}

inline int longestComponent(const glm::dvec3& v) {
    const glm::dvec3 a(std::abs(v.x), std::abs(v.y), std::abs(v.z));
    return a.z >= a.x && a.z >= a.y ? 2 : a.y >= a.x ? 1 : 0;
}

template <class Visit>
void visitIndex(int u, int v, int w, double atU, double atV, double atW, Visit&& visit) {
    glm::uvec3 index;
    index[u] = static_cast<unsigned>(atU);
    index[v] = static_cast<unsigned>(atV);
    index[w] = static_cast<unsigned>(atW);
    visit(index);
}

/// The part of forEachVoxelOf() for triangles that are not inside one row of voxels. Each of the 13
/// conditions is linear in the index, so they are solved for one axis after the other instead of being tried
/// voxel by voxel: rows along v, columns (u, v) of a row, voxels along w, the axis that the triangle faces,
/// of a column.
template <class Visit>
void visitOverlaps(const VoxelTriangle& t, const std::array<Range, 3>& box, double pad, Visit&& visit) {
    const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const int w = longestComponent(normal);
    const int u = (w + 1) % 3;
    const int v = (w + 2) % 3;
    const Axis plane(t, normal, pad);
    const std::array<Axis, 3> uv = axesAcrossEdges(t, u, v, pad);
    const std::array<Axis, 3> vw = axesAcrossEdges(t, v, w, pad);
    const std::array<Axis, 3> uw = axesAcrossEdges(t, u, w, pad);
    for (double atV = box[v].lo; atV <= box[v].hi; ++atV) {
        Range columns = box[u];
        for (const Axis& axis : uv) axis.narrow(columns, u, axis.normal()[v] * atV);
        Range rowDepths = box[w];
        for (const Axis& axis : vw) axis.narrow(rowDepths, w, axis.normal()[v] * atV);
        if (rowDepths.lo > rowDepths.hi) continue;
        for (double atU = columns.lo; atU <= columns.hi; ++atU) {
            Range depths = rowDepths;
            plane.narrow(depths, w, normal[u] * atU + normal[v] * atV);
            for (const Axis& axis : uw) axis.narrow(depths, w, axis.normal()[u] * atU);
            for (double atW = depths.lo; atW <= depths.hi; ++atW) visitIndex(u, v, w, atU, atV, atW, visit);
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
    std::array<Range, 3> box;
    int longAxes = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const Range whole = indexRange(triangle, axis, pad);
        longAxes += whole.lo < whole.hi;
        box[axis] = {std::max(whole.lo, 0.0), std::min(whole.hi, dims[axis] - 1.0)};
        if (box[axis].lo > box[axis].hi) return;
    }
    if (longAxes > 1) return visitOverlaps(triangle, box, pad, visit);
    for (double z = box[2].lo; z <= box[2].hi;
         ++z) // a triangle inside one row meets every voxel between its ends
        for (double y = box[1].lo; y <= box[1].hi; ++y)
            for (double x = box[0].lo; x <= box[0].hi; ++x) visitIndex(0, 1, 2, x, y, z, visit);
}

} // namespace rt
