#pragma once
#include "tools/rt-grid/lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace rt {

/// A triangle in voxel coordinates: voxel (x, y, z) is the cube from (x, y, z) to (x+1, y+1, z+1). Lanes x, y
/// and z of three corners; the last lane is finite.
using VoxelTriangle = LanesTriple;

inline VoxelTriangle voxelTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return {lanesOf(a), lanesOf(b), lanesOf(c)};
}

namespace voxelize {

/// Whole indices from lo to hi, both included; none if lo > hi.
struct Indices {
    int lo;
    int hi;
    int count() const { return hi - lo + 1; }
};

/// Indices from lo to hi, both included and not yet rounded to whole ones. Lane 0 is lo, lane 1 is -hi, the
/// others are of no account.
class RT_LANES_ALIGNED Range {
public:
    explicit Range(const Lanes& loAndMinusHi) : bounds_(loAndMinusHi) {}
    bool empty() const { return bounds_[0] + bounds_[1] > 0.0; }
    Range inBoth(const Range& other) const { return Range(greater(bounds_, other.bounds_)); }
    /// Of a range that is not empty, between -2^30 and 2^30.
    Indices whole() const {
        const IntLanes whole = wholeAbove(bounds_);
        return {whole[0], -whole[1]};
    }

private:
    Lanes bounds_;
};

/// Four conditions lo <= slope * index + others <= hi, solved for the index. Any condition that the padded
/// voxels of a triangle meet is sound, so rounded slopes lose nothing.
class RT_LANES_ALIGNED Conditions {
public:
    Conditions(const Lanes& slope, const Lanes& lo, const Lanes& hi)
        : inverse_(slope == 0.0 ? allLanes(kSteep) : 1.0 / slope), lo_(slope < 0.0 ? hi : lo),
          hi_(slope < 0.0 ? lo : hi) {}
    /// The indices that meet all four.
    Range solve(const Lanes& others) const {
        const Lanes lo = (lo_ - others) * inverse_;
        const Lanes minusHi = (others - hi_) * inverse_;
        const Lanes pairs = greater(__builtin_shufflevector(lo, minusHi, 0, 4, 2, 6),
                                    __builtin_shufflevector(lo, minusHi, 1, 5, 3, 7));
        return Range(greater(pairs, __builtin_shufflevector(pairs, pairs, 2, 3, 2, 3)));
    }

private:
    // Stands for 1 / 0: makes the bounds all or nothing, as `others` meets the condition or not.
    static constexpr double kSteep = 0x1p900;
    Lanes inverse_;
    Lanes lo_, hi_; // exchanged where the slope is negative
};

/// Separating axes as conditions on a voxel's index: the triangle's and the padded voxel's shadows on an axis
/// overlap if and only if lo <= dot(normal, index) <= hi.
struct RT_LANES_ALIGNED Shadows {
    Lanes lo;
    Lanes hi;

    // A normal of 0 has to let everything pass, hence 2^-100.
    Shadows(const Lanes& a, const Lanes& b, const Lanes& middle, const Lanes& radius)
        : lo(lesser(a, b) - middle - (radius + 0x1p-100)), hi(greater(a, b) - middle + (radius + 0x1p-100)) {}
};

/// What the corners have along one axis, the first one again at the end, and what the edges from each to the
/// next one have.
struct RT_LANES_ALIGNED Component {
    Lanes corner;
    Lanes edge;

    explicit Component(const Lanes& corners) : corner(corners), edge(next(corners) - corners) {}
    static Lanes next(const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 1); }
};

/// The axes across the edges and one coordinate axis: the 2D test of the triangle's and the voxel's
/// projections to the plane of the axes u and v. The last lane repeats the first one.
struct RT_LANES_ALIGNED EdgeAxes {
    Lanes normalU;
    Lanes normalV;
    Shadows shadows;

    EdgeAxes(const Component& u, const Component& v, double pad)
        : normalU(v.edge), normalV(-u.edge),
          shadows(normalU * u.corner + normalV * v.corner,
                  normalU * opposite(u.corner) + normalV * opposite(v.corner), 0.5 * (normalU + normalV),
                  (0.5 + pad) * (absolute(normalU) + absolute(normalV))) {}

private:
    static Lanes opposite(const Lanes& v) { return __builtin_shufflevector(v, v, 2, 0, 1, 2); }
};

/// The edges' conditions on (u, v), and that u is in the box: solved for u.
class RT_LANES_ALIGNED RowSolver {
public:
    RowSolver(const Component& u, const Component& v, const Indices& boxU, double pad)
        : RowSolver(EdgeAxes(u, v, pad), boxU) {}
    Range at(int v) const { return conditions_.solve(normalV_ * static_cast<double>(v)); }

private:
    RowSolver(const EdgeAxes& axes, const Indices& boxU)
        : conditions_(withLast(axes.normalU, 1.0), withLast(axes.shadows.lo, boxU.lo),
                      withLast(axes.shadows.hi, boxU.hi)),
          normalV_(withLast(axes.normalV, 0.0)) {}
    Conditions conditions_;
    Lanes normalV_;
};

/// The plane's axis. All three corners count: a sliver's normal is mostly rounding.
inline Shadows planeShadows(const Component& u, const Component& v, const Component& w,
                            const glm::dvec3& normal, double pad) {
    const Lanes d = normal.x * u.corner + normal.y * v.corner + normal.z * w.corner;
    return {allLanes(std::min({d[0], d[1], d[2]})), allLanes(std::max({d[0], d[1], d[2]})),
            allLanes(0.5 * (normal.x + normal.y + normal.z)),
            allLanes((0.5 + pad) * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)))};
}

/// The plane's condition and those of the edges seen along v: solved for w.
class RT_LANES_ALIGNED ColumnSolver {
public:
    ColumnSolver(const Component& u, const Component& v, const Component& w, const glm::dvec3& normal,
                 double pad)
        : ColumnSolver(EdgeAxes(w, u, pad), planeShadows(u, v, w, normal, pad), normal) {}
    Range at(int u, int v) const {
        return conditions_.solve(normalU_ * static_cast<double>(u) + normalV_ * static_cast<double>(v));
    }

private:
    ColumnSolver(const EdgeAxes& axes, const Shadows& plane, const glm::dvec3& normal)
        : conditions_(withLast(axes.normalU, normal.z), withLast(axes.shadows.lo, plane.lo[0]),
                      withLast(axes.shadows.hi, plane.hi[0])),
          normalU_(withLast(axes.normalV, normal.x)), normalV_(withLast(allLanes(0.0), normal.y)) {}
    Conditions conditions_;
    Lanes normalU_, normalV_;
};

/// x, y and z, each of all three corners and then of the first one again.
inline LanesTriple transposed(const VoxelTriangle& t) {
    const Lanes abXZ = __builtin_shufflevector(t[0], t[1], 0, 4, 2, 6);
    const Lanes abY = __builtin_shufflevector(t[0], t[1], 1, 5, 3, 7);
    const Lanes caXZ = __builtin_shufflevector(t[2], t[0], 0, 4, 2, 6);
    const Lanes caY = __builtin_shufflevector(t[2], t[0], 1, 5, 3, 7);
    return {__builtin_shufflevector(abXZ, caXZ, 0, 1, 4, 5), __builtin_shufflevector(abY, caY, 0, 1, 4, 5),
            __builtin_shufflevector(abXZ, caXZ, 2, 3, 6, 7)};
}

inline Lanes normalOf(const VoxelTriangle& t) {
    const auto yzx = [](const Lanes& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); };
    const Lanes a = t[1] - t[0];
    const Lanes b = t[2] - t[0];
    return yzx(a * yzx(b) - yzx(a) * b);
}

inline std::size_t longestComponent(const Lanes& v) {
    const Lanes a = absolute(v);
    const double most = std::max(a[0], a[1]);
    return a[2] >= most ? 2u : static_cast<std::size_t>(a[1] >= a[0]);
}

/// Voxels along each axis that the bounds of a triangle, grown by the pad, meet.
struct Box {
    IntLanes first, last;  ///< inside the grid; lane 3 is of no account
    unsigned longAxes = 0; ///< bit i: along axis i they are several, were the grid endless
    bool empty = true;

    Box() = default;
    Box(const VoxelTriangle& t, const glm::uvec3& dims, double pad) {
        constexpr double kFar = 0x1p30; // farther ones are as good as here
        const auto bounded = [](const Lanes& v) {
            return greater(lesser(v, allLanes(kFar)), allLanes(-kFar));
        };
        const IntLanes lo = wholeAbove(bounded(lesser(lesser(t[0], t[1]), t[2]) - (pad + 1.0)));
        const IntLanes hi = -wholeAbove(bounded(-pad - greater(greater(t[0], t[1]), t[2])));
        first = greater(lo, IntLanes{});
        last = lesser(hi, IntLanes{int(dims.x) - 1, int(dims.y) - 1, int(dims.z) - 1, 0});
        const IntLanes bits = ((lo < hi) & IntLanes{1, 2, 4, 0}) | ((first > last) & IntLanes{8, 8, 8, 0});
        const auto flags = static_cast<unsigned>(bits[0] | bits[1] | bits[2]);
        longAxes = flags & 7;
        empty = flags > 7;
    }
    Indices along(std::size_t axis) const { return {first[axis], last[axis]}; }
};

/// Which voxels of a box of at most 4x4x4 a triangle meets: bit x + 4 y + 16 z, counted from the box's first
/// voxel. Tries them all, four in a row at once, which is quicker than to solve conditions for so few.
class SmallBox {
public:
    static constexpr int kSide = 4;
    static bool holds(const Box& box) {
        return box.along(0).count() <= kSide && box.along(1).count() <= kSide &&
               box.along(2).count() <= kSide;
    }

    SmallBox(const Box& box, double pad) : box_(box), pad_(pad) {}
    std::uint64_t voxelsOf(const VoxelTriangle& t) const;

private:
    static constexpr std::array<int, 3> kStride{1, 4, 16}; // bits from one voxel to the next

    /// Times this, bits of voxels are set in so many, one after the other along an axis.
    template <std::size_t kAxis>
    static std::uint64_t copies(int count) {
        constexpr std::array<std::uint64_t, 3> kCopies{0xF, 0x1111, 0x0001000100010001};
        return kCopies[kAxis] & (~std::uint64_t(0) >> (64 - count * kStride[kAxis]));
    }
    /// The voxels of the box.
    std::uint64_t all() const {
        return copies<0>(box_.along(0).count()) * copies<1>(box_.along(1).count()) *
               copies<2>(box_.along(2).count());
    }
    /// Four voxels one after the other: their indices and bits.
    Lanes indicesAlong(std::size_t axis) const {
        return allLanes(box_.along(axis).lo) + Lanes{0.0, 1.0, 2.0, 3.0};
    }
    template <std::size_t kAxis>
    static BitLanes bitsAlong() {
        constexpr int kStep = kStride[kAxis];
        return BitLanes{1, 1L << kStep, 1L << 2 * kStep, 1L << 3 * kStep};
    }
    static std::uint64_t together(const BitLanes& bits) {
        return static_cast<std::uint64_t>(bits[0] | bits[1] | bits[2] | bits[3]);
    }
    template <std::size_t kAxis>
    std::uint64_t seenAlong(const std::array<Component, 3>& xyz) const;
    std::uint64_t nearPlane(const std::array<Component, 3>& xyz, const Lanes& normal) const;

    const Box& box_;
    double pad_;
};

/// Voxels that the edges' conditions let pass, seen along an axis.
template <std::size_t kAxis>
std::uint64_t SmallBox::seenAlong(const std::array<Component, 3>& xyz) const {
    constexpr std::size_t kU = (kAxis + 1) % 3;
    constexpr std::size_t kV = (kAxis + 2) % 3;
    if ((box_.longAxes | 1u << kAxis) != 7) return ~std::uint64_t(0); // the bounds decide
    const EdgeAxes axes(xyz[kU], xyz[kV], pad_);
    const Lanes us = indicesAlong(kU);
    BitLanes bits = bitsAlong<kU>();
    BitLanes met{};
    for (int v = box_.along(kV).lo; v <= box_.along(kV).hi; ++v, bits <<= kStride[kV]) {
        const Lanes others = axes.normalV * static_cast<double>(v);
        BitLanes meets = bits;
        for (int edge = 0; edge < 3; ++edge) {
            const Lanes value = axes.normalU[edge] * us + others[edge];
            meets &= (value >= axes.shadows.lo[edge]) & (value <= axes.shadows.hi[edge]);
        }
        met |= meets;
    }
    return together(met) * copies<kAxis>(kSide);
}

/// Voxels that the plane's condition lets pass.
inline std::uint64_t SmallBox::nearPlane(const std::array<Component, 3>& xyz, const Lanes& normal) const {
    const Shadows plane = planeShadows(xyz[0], xyz[1], xyz[2], {normal[0], normal[1], normal[2]}, pad_);
    const Lanes alongX = normal[0] * indicesAlong(0);
    const Indices boxY = box_.along(1);
    const Indices boxZ = box_.along(2);
    BitLanes met{};
    BitLanes layer = bitsAlong<0>();
    for (int z = boxZ.lo; z <= boxZ.hi; ++z, layer <<= kStride[2]) {
        BitLanes bits = layer;
        for (int y = boxY.lo; y <= boxY.hi; ++y, bits <<= kStride[1]) {
            const Lanes value = alongX + (normal[1] * y + normal[2] * z);
            met |= bits & (value >= plane.lo) & (value <= plane.hi);
        }
    }
    return together(met);
}

inline std::uint64_t SmallBox::voxelsOf(const VoxelTriangle& t) const {
    const LanesTriple corners = transposed(t);
    const std::array<Component, 3> xyz{Component(corners[0]), Component(corners[1]), Component(corners[2])};
    const std::uint64_t met = all() & seenAlong<0>(xyz) & seenAlong<1>(xyz) & seenAlong<2>(xyz);
    return box_.longAxes == 7 ? met & nearPlane(xyz, normalOf(t)) : met;
}

/// A triangle's components and its box with the axes turned, so that a given one comes last, and how far
/// apart in memory voxels are along them.
struct Turned {
    Component u, v, w;
    Indices boxU, boxV, boxW;
    std::uint32_t strideU, strideV, strideW;

    Turned(const LanesTriple& xyz, const Box& box, const std::array<std::uint32_t, 3>& strides,
           std::size_t last)
        : Turned(xyz, box, strides, (last + 1) % 3, (last + 2) % 3, last) {}

private:
    Turned(const LanesTriple& xyz, const Box& box, const std::array<std::uint32_t, 3>& strides, std::size_t i,
           std::size_t j, std::size_t k)
        : u(xyz[i]), v(xyz[j]), w(xyz[k]), boxU(box.along(i)), boxV(box.along(j)), boxW(box.along(k)),
          strideU(strides[i]), strideV(strides[j]), strideW(strides[k]) {}
};

template <class Visit>
void visitRow(std::uint32_t origin, const Indices& along, std::uint32_t stride, Visit&& visit) {
    std::uint32_t index = origin + static_cast<std::uint32_t>(along.lo) * stride;
    for (int i = along.lo; i <= along.hi; ++i, index += stride) visit(index);
}

/// The part of forEachVoxelOf() for triangles that one layer of voxels across w holds: in it the projections
/// along that axis decide.
template <class Visit>
void visitLayer(const Turned& t, double pad, Visit&& visit) {
    const RowSolver rows(t.u, t.v, t.boxU, pad);
    const std::uint32_t layer = static_cast<std::uint32_t>(t.boxW.lo) * t.strideW;
    for (int v = t.boxV.lo; v <= t.boxV.hi; ++v) {
        const Range columns = rows.at(v);
        if (columns.empty()) continue;
        visitRow(layer + static_cast<std::uint32_t>(v) * t.strideV, columns.whole(), t.strideU, visit);
    }
}

/// The part of forEachVoxelOf() for triangles that no layer of voxels holds; they face w. Each of the 13
/// conditions is linear in the index, so they are solved for one axis after the other instead of being tried
/// voxel by voxel: rows along v, columns (u, v) of a row, voxels along w of a column.
template <class Visit>
void visitOverlaps(const Turned& t, const glm::dvec3& normal, double pad, Visit&& visit) {
    const RowSolver columnsOfRow(t.u, t.v, t.boxU, pad);
    const RowSolver depthsOfRow(t.w, t.v, t.boxW, pad);
    const ColumnSolver depthsOfColumn(t.u, t.v, t.w, normal, pad);
    for (int v = t.boxV.lo; v <= t.boxV.hi; ++v) {
        const Range columns = columnsOfRow.at(v);
        const Range rowDepths = depthsOfRow.at(v);
        if (columns.empty() || rowDepths.empty()) continue;
        const Indices whole = columns.whole();
        for (int u = whole.lo; u <= whole.hi; ++u) {
            const Range depths = rowDepths.inBoth(depthsOfColumn.at(u, v));
            if (depths.empty()) continue;
            visitRow(static_cast<std::uint32_t>(u) * t.strideU + static_cast<std::uint32_t>(v) * t.strideV,
                     depths.whole(), t.strideW, visit);
        }
    }
}

} // namespace voxelize

/// forEachVoxelOf() where the triangle's box is known: to find those of several triangles first is quicker.
template <class Visit>
void forEachVoxelOf(const VoxelTriangle& triangle, const voxelize::Box& box, const glm::uvec3& dims,
                    double pad, Visit&& visit) {
    using namespace voxelize;
    if (box.empty) return;
    const std::array<std::uint32_t, 3> strides{1u, dims.x, dims.x * dims.y};
    if (std::popcount(box.longAxes) >= 2 && SmallBox::holds(box)) {
        const std::uint32_t first = static_cast<std::uint32_t>(box.along(2).lo) * strides[2] +
                                    static_cast<std::uint32_t>(box.along(1).lo) * strides[1] +
                                    static_cast<std::uint32_t>(box.along(0).lo);
        for (std::uint64_t met = SmallBox(box, pad).voxelsOf(triangle); met != 0; met &= met - 1) {
            const auto bit = static_cast<std::uint32_t>(std::countr_zero(met));
            visit(first + (bit & 3) + (bit >> 2 & 3) * strides[1] + (bit >> 4) * strides[2]);
        }
        return;
    }
    switch (box.longAxes) {
    case 7: {
        const Lanes normal = normalOf(triangle);
        const std::size_t last = longestComponent(normal);
        const Turned turned(transposed(triangle), box, strides, last);
        return visitOverlaps(turned, {normal[(last + 1) % 3], normal[(last + 2) % 3], normal[last]}, pad,
                             visit);
    }
    case 3:
    case 5:
    case 6:
        return visitLayer(Turned(transposed(triangle), box, strides,
                                 static_cast<std::size_t>(std::countr_one(box.longAxes))),
                          pad, visit);
    default: // inside one row: every voxel between its ends
        for (int z = box.along(2).lo; z <= box.along(2).hi; ++z)
            for (int y = box.along(1).lo; y <= box.along(1).hi; ++y)
                visitRow(static_cast<std::uint32_t>(z) * strides[2] + static_cast<std::uint32_t>(y) * dims.x,
                         box.along(0), 1u, visit);
    }
}

/// Calls visit(std::uint32_t index) once for each voxel of a grid of `dims` voxels, counted x fastest, whose
/// cube, grown by `pad` on every side, meets the triangle. Exact but for rounding of about 1e-15 * dims
/// voxels, which the pad swallows: a voxel that the triangle enters is never missed. Triangles may be
/// degenerate (a segment, a point) but must be finite. Source: the separating axes of Akenine-Moller 2001,
/// evaluated by columns as in Schwarz & Seidel 2010.
template <class Visit>
void forEachVoxelOf(const VoxelTriangle& triangle, const glm::uvec3& dims, double pad, Visit&& visit) {
    forEachVoxelOf(triangle, voxelize::Box(triangle, dims, pad), dims, pad, visit);
}

} // namespace rt
