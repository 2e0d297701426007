// Binning against an independent judge: clipping of the triangle by the voxel's box (Sutherland & Hodgman
// 1974) in long double.
#include "tools/rt-grid/voxelize_triangle.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

namespace rt {
namespace {

using Point = glm::vec<3, long double>;
using Polygon = std::vector<Point>;

constexpr double kPad = 0x1p-8;
constexpr double kTolerance = 1e-7; // voxels; what rounding may decide either way

Polygon clipped(const Polygon& polygon, int axis, long double bound, bool keepAbove) {
    Polygon kept;
    const auto height = [&](const Point& p) { return keepAbove ? p[axis] - bound : bound - p[axis]; };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        const long double ha = height(a);
        const long double hb = height(b);
        if (ha >= 0) kept.push_back(a);
        if ((ha < 0) != (hb < 0)) {
            Point crossing = a + (b - a) * (ha / (ha - hb));
            crossing[axis] = bound;
            kept.push_back(crossing);
        }
    }
    return kept;
}

using Corners = std::array<glm::dvec3, 3>;

// Whether the triangle meets the voxel's cube grown by `pad`.
bool meets(const Corners& triangle, const glm::uvec3& voxel, double pad) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto [lo, hi] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
        if (lo > voxel[axis] + 1.0 + pad || hi < voxel[axis] - pad) return false;
    }
    Polygon polygon{Point(triangle[0]), Point(triangle[1]), Point(triangle[2])};
    for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
        polygon = clipped(polygon, axis, static_cast<long double>(voxel[axis]) - pad, true);
        polygon = clipped(polygon, axis, static_cast<long double>(voxel[axis]) + 1 + pad, false);
    }
    return !polygon.empty();
}

struct Disagreements {
    std::size_t missed = 0;   // voxels that the triangle meets, not listed
    std::size_t spurious = 0; // listed, not met
    std::size_t twice = 0;    // listed more than once
    std::size_t listed = 0;
};

void compare(const Corners& triangle, const glm::uvec3& dims, Disagreements& found) {
    std::vector<int> visits(std::size_t(dims.x) * dims.y * dims.z, 0);
    const VoxelTriangle corners = voxelTriangle(triangle[0], triangle[1], triangle[2]);
    forEachVoxelOf(corners, dims, kPad, [&](std::uint32_t voxel) {
        ASSERT_LT(voxel, visits.size());
        ++visits[voxel];
    });
    std::size_t i = 0;
    for (unsigned z = 0; z < dims.z; ++z)
        for (unsigned y = 0; y < dims.y; ++y)
            for (unsigned x = 0; x < dims.x; ++x, ++i) {
                const glm::uvec3 voxel(x, y, z);
                found.listed += visits[i] > 0;
                found.twice += visits[i] > 1;
                if (visits[i] == 0)
                    found.missed += meets(triangle, voxel, kPad - kTolerance);
                else
                    found.spurious += !meets(triangle, voxel, kPad + kTolerance);
            }
}

class GridVoxelize : public testing::Test {
protected:
    double uniform(double lo, double hi) { return std::uniform_real_distribution(lo, hi)(random_); }
    glm::dvec3 point(double lo, double hi) { return {uniform(lo, hi), uniform(lo, hi), uniform(lo, hi)}; }
    // Whole coordinates as often as not: faces, edges and corners of voxels.
    glm::dvec3 latticePoint() {
        glm::dvec3 p = point(-1.0, 10.0);
        for (int axis = 0; axis < 3; ++axis)
            if (random_() % 2) p[axis] = std::round(p[axis]);
        return p;
    }
    void expectAgreement(int count, const std::function<Corners()>& next) {
        Disagreements found;
        for (int i = 0; i < count; ++i) compare(next(), glm::uvec3(9, 7, 8), found);
        EXPECT_EQ(found.missed, 0u);
        EXPECT_EQ(found.spurious, 0u);
        EXPECT_EQ(found.twice, 0u);
        EXPECT_GT(found.listed, std::size_t(count)); // the cases did reach the grid
    }
    std::mt19937_64 random_{7};
};

TEST_F(GridVoxelize, smallTriangles) {
    expectAgreement(6000, [&] {
        const glm::dvec3 at = point(0.0, 7.0);
        return Corners{at + point(-0.7, 0.7), at + point(-0.7, 0.7), at + point(-0.7, 0.7)};
    });
}

TEST_F(GridVoxelize, largeTriangles) {
    expectAgreement(3000, [&] { return Corners{point(-3, 12), point(-3, 12), point(-3, 12)}; });
}

TEST_F(GridVoxelize, giantTrianglesThatLeaveTheGrid) {
    expectAgreement(3000, [&] {
        const glm::dvec3 inside = point(1.0, 7.0);
        const glm::dvec3 a = point(-2000, 2000);
        return Corners{inside + a, inside + point(-2000, 2000), inside - a};
    });
}

TEST_F(GridVoxelize, slivers) {
    expectAgreement(4000, [&] {
        const glm::dvec3 a = point(-2, 10);
        const glm::dvec3 b = point(-2, 10);
        const double width = std::pow(10.0, uniform(-16, -1));
        return Corners{a, b, a + (b - a) * uniform(-0.2, 1.2) + point(-width, width)};
    });
}

TEST_F(GridVoxelize, trianglesInVoxelFacesAndAlongVoxelEdges) {
    expectAgreement(6000, [&] {
        Corners t{latticePoint(), latticePoint(), latticePoint()};
        const auto axis = static_cast<int>(random_() % 4); // 3: in no plane
        if (axis < 3) t[0][axis] = t[1][axis] = t[2][axis] = std::round(uniform(0.0, 7.0));
        return t;
    });
}

TEST_F(GridVoxelize, trianglesTouchingTheGrownBoxOnly) {
    expectAgreement(4000, [&] { // planes just above and just below the pad over a face
        Corners t{point(-1, 10), point(-1, 10), point(-1, 10)};
        const auto axis = static_cast<int>(random_() % 3);
        const double distance = kPad * (random_() % 2 ? 0.999 : 1.001) * (random_() % 2 ? 1.0 : -1.0);
        t[0][axis] = t[1][axis] = t[2][axis] = std::round(uniform(1.0, 6.0)) + distance;
        return t;
    });
}

TEST_F(GridVoxelize, segmentsAndPoints) {
    expectAgreement(4000, [&] {
        const glm::dvec3 a = random_() % 2 ? latticePoint() : point(-2, 10);
        const glm::dvec3 b = random_() % 4 ? point(-2, 10) : latticePoint();
        switch (random_() % 4) {
        case 0:
            return Corners{a, b, a};
        case 1:
            return Corners{a, b, 0.5 * (a + b)};
        case 2:
            return Corners{a, b, b};
        default: {
            const glm::dvec3 p = glm::clamp(a, glm::dvec3(0.0), glm::dvec3(6.9));
            return Corners{p, p, p};
        }
        }
    });
}

} // namespace
} // namespace rt
