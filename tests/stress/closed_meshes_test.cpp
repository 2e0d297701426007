// Rays from inside closed meshes: each has to hit something, at any scale and any distance from the origin.
#include "tests/gpu/trace_fixture.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

namespace rt {
namespace {

std::size_t raysPerCase() {
    const char* const text = std::getenv("RT_STRESS_RAYS");
    return text ? std::strtoull(text, nullptr, 10) : 330'000;
}

/// A closed mesh of about unit size and points that are well inside.
struct ClosedMesh {
    const char* name;
    Mesh mesh;
    std::vector<glm::vec3> insides;
};

ClosedMesh sphere() {
    return {"sphere", test::makeSphere(4), {{0.0f, 0.0f, 0.0f}, {0.1f, -0.2f, 0.05f}}};
}

ClosedMesh torus() {
    ClosedMesh closed{"torus", test::makeTorus(0.7f, 0.25f, 96, 48), {}};
    for (int i = 0; i < 32; ++i) {
        const float angle = 0.2f * static_cast<float>(i);
        closed.insides.emplace_back(0.7f * std::cos(angle), 0.7f * std::sin(angle), 0.0f);
    }
    return closed;
}

/// Where a mesh is put: p * scale + offset.
struct Placement {
    const char* name;
    float scale;
    glm::vec3 offset;

    ClosedMesh of(const ClosedMesh& closed) const {
        ClosedMesh placed{closed.name, test::moved(closed.mesh, scale, offset), closed.insides};
        for (glm::vec3& p : placed.insides) p = p * scale + offset;
        return placed;
    }
};

const Placement kPlacements[] = {
    {"as it is", 1.0f, glm::vec3(0.0f)},
    {"scale 1e-12", 1e-12f, glm::vec3(0.0f)},
    {"scale 1e-6", 1e-6f, glm::vec3(0.0f)},
    {"scale 1e6", 1e6f, glm::vec3(0.0f)},
    {"scale 1e12", 1e12f, glm::vec3(0.0f)},
    {"offset 1e3 sizes", 0.3f, {300.0f, -170.0f, 20.0f}},
    {"offset 2e5 sizes", 1.0f, {148376.0f, 1234.0f, -223423.0f}},
};
// Floats are whole numbers there: what is left of the sphere still has an inside, the torus' tube has none.
const Placement kSphereOnly = {"offset 1e7 sizes", 1.0f, {-1e7f, 3e6f, 9e6f}};

class RaySource {
public:
    RaySource(const ClosedMesh& closed, const GridParams& grid) : closed_(closed), grid_(grid) {}

    /// From an inside point at a vertex, at an edge, at a corner of a voxel, or anywhere.
    QueryRay next() {
        const glm::vec3 origin = closed_.insides[index(closed_.insides.size())];
        const std::size_t kind = index(4);
        glm::vec3 direction = kind == 0   ? vertexOf(triangle(), 0) - origin
                              : kind == 1 ? edgePoint() - origin
                              : kind == 2 ? voxelCorner() - origin
                                          : glm::vec3(normal_(random_), normal_(random_), normal_(random_));
        if (direction == glm::vec3(0.0f)) direction.x = 1.0f;
        return {glm::vec4(origin, 0.0f), glm::vec4(direction, 1e38f)};
    }

private:
    std::size_t index(std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
    }
    glm::uvec3 triangle() { return closed_.mesh.triangles[index(closed_.mesh.triangles.size())]; }
    glm::vec3 vertexOf(const glm::uvec3& triangle, int corner) const {
        return closed_.mesh.positions[triangle[corner]];
    }
    glm::vec3 edgePoint() {
        const glm::uvec3 t = triangle();
        return glm::mix(vertexOf(t, 0), vertexOf(t, 1), unit_(random_));
    }
    glm::vec3 voxelCorner() {
        const glm::vec3 corner(index(grid_.dims.x + 1), index(grid_.dims.y + 1), index(grid_.dims.z + 1));
        const glm::vec3 inAtlas = glm::vec3(grid_.gridLo) + corner * glm::vec3(grid_.cellSize);
        return inAtlas / grid_.worldOffset.w + glm::vec3(grid_.worldOffset);
    }

    const ClosedMesh& closed_;
    GridParams grid_;
    std::mt19937 random_{7};
    std::uniform_real_distribution<float> unit_{0.0f, 1.0f};
    std::normal_distribution<float> normal_;
};

class ClosedMeshes : public test::OnGpu {
protected:
    // Rays that leave the mesh without a hit.
    static std::size_t leaks(const ClosedMesh& closed, std::uint32_t structure, unsigned intersect) {
        const Atlas atlas = test::makeAtlas(closed.mesh, structure, {12, 11, 10});
        constexpr std::size_t kBatch = 1u << 22;
        RaySource source(closed, atlas.grid);
        std::size_t lost = 0;
        for (std::size_t done = 0; done < raysPerCase(); done += kBatch) {
            std::vector<QueryRay> rays(std::min(kBatch, raysPerCase() - done));
            std::generate(rays.begin(), rays.end(), [&] { return source.next(); });
            const auto hits = test::traceQuery(*context, atlas, rays, {.limits = {}, .intersect = intersect});
            lost += static_cast<std::size_t>(std::count_if(
                hits.begin(), hits.end(), [](const QueryHit& hit) { return hit.tuvId.w == kNoTriangle; }));
        }
        return lost;
    }

    static void report(const ClosedMesh& closed, const char* placement, const char* test, std::size_t lost) {
        fmt::print("{}, {}, {}: {} of {} rays leak\n", closed.name, placement, test, lost, raysPerCase());
    }

    static void expectNoLeak(const ClosedMesh& closed, const Placement& placement) {
        const ClosedMesh placed = placement.of(closed);
        for (const std::uint32_t structure : {kStructureCloud, kStructureNested}) {
            const std::size_t lost = leaks(placed, structure, kIntersectWatertight);
            report(placed, placement.name, "watertight", lost);
            EXPECT_EQ(lost, 0u) << closed.name << ", " << placement.name << ", structure " << structure;
        }
    }
};

TEST_F(ClosedMeshes, TheWatertightTestLosesNoRayInASphere) {
    for (const Placement& placement : kPlacements) expectNoLeak(sphere(), placement);
    expectNoLeak(sphere(), kSphereOnly);
}

TEST_F(ClosedMeshes, TheWatertightTestLosesNoRayInATorus) {
    for (const Placement& placement : kPlacements) expectNoLeak(torus(), placement);
}

// The rates of the others are measured, not judged; but that they leak shows that these rays can find leaks.
TEST_F(ClosedMeshes, TheOtherTestsLoseRays) {
    for (const ClosedMesh& closed : {sphere(), torus()}) {
        const std::size_t mollerTrumbore = leaks(closed, kStructureNested, kIntersectMollerTrumbore);
        const std::size_t baldwinWeber = leaks(closed, kStructureNested, kIntersectBaldwinWeber);
        report(closed, "as it is", "moller-trumbore", mollerTrumbore);
        report(closed, "as it is", "baldwin-webber", baldwinWeber);
        EXPECT_GT(mollerTrumbore, 0u);
        EXPECT_GT(baldwinWeber, 0u);
    }
}

} // namespace
} // namespace rt
