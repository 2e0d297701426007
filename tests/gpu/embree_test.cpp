// Ray queries of the real tools against Embree on a real model.
#include "formats/mesh_file.h"
#include "tests/support/embree_scene.h"
#include "tests/support/run_command.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <random>

namespace rt {
namespace {

struct Ray {
    glm::vec3 origin;
    float tMin;
    glm::vec3 direction;
    float tMax;
};
struct Hit {
    float t, u, v;
    std::uint32_t triangle;
};
static_assert(sizeof(Ray) == 32 && sizeof(Hit) == 16);
constexpr std::uint32_t kMiss = 0xFFFFFFFFu;

class EmbreeScene {
public:
    explicit EmbreeScene(const Mesh& mesh)
        : device_(rtcNewDevice(nullptr)), scene_(test::newEmbreeScene(device_, mesh)) {
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    Hit trace(const Ray& ray) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        query.ray = {ray.origin.x,
                     ray.origin.y,
                     ray.origin.z,
                     ray.tMin,
                     ray.direction.x,
                     ray.direction.y,
                     ray.direction.z,
                     0.0f,
                     ray.tMax,
                     ~0u,
                     0,
                     0};
        query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {-1.0f, 0.0f, 0.0f, kMiss};
        return {query.ray.tfar, query.hit.u, query.hit.v, query.hit.primID};
    }

private:
    RTCDevice device_;
    RTCScene scene_;
};

// Half of the rays start outside and half inside the bounds; directions are random. A few have tMin and tMax.
std::vector<Ray> makeRays(const Bounds& bounds, std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::normal_distribution<float> normal;
    std::vector<Ray> rays;
    const float size = glm::length(bounds.extent());
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 inside =
            bounds.lo + bounds.extent() * glm::vec3(unit(random), unit(random), unit(random));
        const glm::vec3 direction(normal(random), normal(random), normal(random));
        const bool outside = i % 2 == 0;
        const glm::vec3 origin = outside ? inside - glm::normalize(direction) * 1.5f * size : inside;
        const bool limited = i % 16 == 3;
        rays.push_back({origin, limited ? 0.01f * size : 0.0f, direction, limited ? 0.2f * size : 1e30f});
    }
    return rays;
}

template <class T>
std::vector<T> readRecords(const std::string& path) {
    const auto bytes = readFile(path);
    std::vector<T> records(bytes.size() / sizeof(T));
    std::memcpy(records.data(), bytes.data(), records.size() * sizeof(T));
    return records;
}

struct Corners {
    glm::dvec3 a, b, c;
};

Corners cornersOf(const Mesh& mesh, std::uint32_t triangle) {
    const glm::uvec3 t = mesh.triangles[triangle];
    return {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
}

glm::dvec3 pointOf(const Mesh& mesh, const Hit& hit) {
    const Corners k = cornersOf(mesh, hit.triangle);
    return k.a + (k.b - k.a) * double(hit.u) + (k.c - k.a) * double(hit.v);
}

// In the triangle's plane and not outside any of its edges, by more than `tolerance` (world units).
bool liesOn(const Corners& k, const glm::dvec3& point, double tolerance) {
    const glm::dvec3 n = glm::normalize(glm::cross(k.b - k.a, k.c - k.a));
    if (!(std::abs(glm::dot(point - k.a, n)) <= tolerance)) return false;
    const auto isInside = [&](const glm::dvec3& from, const glm::dvec3& to) {
        return glm::dot(glm::cross(n, glm::normalize(to - from)), point - from) >= -tolerance;
    };
    return isInside(k.a, k.b) && isInside(k.b, k.c) && isInside(k.c, k.a);
}

// The model holds some triangles twice; either of the two is right.
bool isTwin(const Corners& k, const Corners& other) {
    const auto isCorner = [&](const glm::dvec3& p) { return p == other.a || p == other.b || p == other.c; };
    return isCorner(k.a) && isCorner(k.b) && isCorner(k.c);
}

enum class Agreement { Same, Twin, Tie, None };

// Same triangle, or a tie between two that meet there. Coordinates carry rounding errors in proportion to
// their size, so the distances of a hit close to a far origin may differ by more than a part of t. Embree's u
// and v of a slender triangle are up to 2.8e-5 of that size from the hit point, ours up to 2.2e-5.
Agreement agreementOf(const Mesh& mesh, const Ray& ray, const Hit& ours, const Hit& embree) {
    if (ours.triangle == kMiss || embree.triangle == kMiss)
        return ours.triangle == embree.triangle ? Agreement::Same : Agreement::None;
    if (ours.triangle >= mesh.triangles.size()) return Agreement::None;
    const bool isSame = ours.triangle == embree.triangle;
    const double distanceApart = std::abs(double(ours.t) - embree.t) * glm::length(ray.direction);
    const double size = glm::length(ray.origin) + glm::length(embree.t * ray.direction);
    if (!(distanceApart <= (isSame ? 1e-5 : 1e-6) * size))
        return Agreement::None; // grazing hits are far apart
    const glm::dvec3 point = pointOf(mesh, embree);
    if (!(glm::distance(pointOf(mesh, ours), point) <= 5e-5 * size)) return Agreement::None;
    if (isSame) return Agreement::Same;
    const Corners corners = cornersOf(mesh, ours.triangle);
    if (!liesOn(corners, point, 1e-6 * size)) return Agreement::None;
    return isTwin(corners, cornersOf(mesh, embree.triangle)) ? Agreement::Twin : Agreement::Tie;
}

// Where a ray passes a silhouette by less than rounding: the triangles at the edge face different ways, and
// hit or miss are both right.
constexpr std::size_t kLostRaysAllowed = 2;

std::string tool(const char* name) {
    return std::string(RT_BIN_DIR) + "/" + name;
}

// Imports and builds once for all tests of this file.
class EmbreeAgreement : public testing::TestWithParam<const char*> {
protected:
    static void SetUpTestSuite() {
        folder = std::make_unique<test::TemporaryFolder>();
        const auto import =
            test::runCommand({tool("rt-import"), test::poolTablePath(), "-o", folder->file("p.rtmesh")});
        ASSERT_EQ(import.exitCode, 0) << import.err;
        mesh = readMesh(folder->file("p.rtmesh")).mesh;
        ASSERT_EQ(mesh.triangles.size(), 56576u);
        rays = makeRays(boundsOf(mesh), 400000);
        std::ofstream(folder->file("rays"), std::ios::binary)
            .write(reinterpret_cast<const char*>(rays.data()),
                   static_cast<std::streamsize>(rays.size() * sizeof(Ray)));
        const EmbreeScene embree(mesh);
        expected.resize(rays.size());
        std::transform(rays.begin(), rays.end(), expected.begin(),
                       [&](const Ray& ray) { return embree.trace(ray); });
    }
    static void TearDownTestSuite() { folder.reset(); }

    static void expectAgreement(const std::vector<Hit>& hits);

    static std::unique_ptr<test::TemporaryFolder> folder;
    static Mesh mesh;
    static std::vector<Ray> rays;
    static std::vector<Hit> expected;
};
std::unique_ptr<test::TemporaryFolder> EmbreeAgreement::folder;
Mesh EmbreeAgreement::mesh;
std::vector<Ray> EmbreeAgreement::rays;
std::vector<Hit> EmbreeAgreement::expected;

void EmbreeAgreement::expectAgreement(const std::vector<Hit>& hits) {
    std::size_t hitCount = 0, twinCount = 0, tieCount = 0, lostCount = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hitCount += hits[i].triangle != kMiss;
        const Agreement agreement = agreementOf(mesh, rays[i], hits[i], expected[i]);
        twinCount += agreement == Agreement::Twin;
        tieCount += agreement == Agreement::Tie;
        if (agreement != Agreement::None) continue;
        if (++lostCount > 10) continue;
        std::cout << "ray " << i << ": triangle " << hits[i].triangle << " at " << hits[i].t << ", Embree "
                  << expected[i].triangle << " at " << expected[i].t << "\n";
    }
    std::cout << hitCount << " hits, " << twinCount << " on twins, " << tieCount << " ties, " << lostCount
              << " lost\n";
    EXPECT_GT(hitCount, rays.size() / 10);
    EXPECT_LE(tieCount, hitCount / 10000); // a random ray rarely meets an edge
    EXPECT_LE(lostCount, kLostRaysAllowed);
}

TEST_P(EmbreeAgreement, NearestAndAnyHits) {
    const std::string atlas = folder->file("p.rtatlas");
    const auto grid =
        test::runCommand({tool("rt-grid"), folder->file("p.rtmesh"), "-o", atlas, "--structure", GetParam()});
    ASSERT_EQ(grid.exitCode, 0) << grid.err;
    const auto query = test::runCommand(
        {tool("rt-trace"), atlas, "--rays", folder->file("rays"), "-o", folder->file("hits")});
    ASSERT_EQ(query.exitCode, 0) << query.err;
    const auto hits = readRecords<Hit>(folder->file("hits"));
    ASSERT_EQ(hits.size(), rays.size());
    expectAgreement(hits);

    const auto any = test::runCommand(
        {tool("rt-trace"), atlas, "--rays", folder->file("rays"), "-o", folder->file("any"), "--any-hit"});
    ASSERT_EQ(any.exitCode, 0) << any.err;
    const auto anyHits = readRecords<Hit>(folder->file("any"));
    ASSERT_EQ(anyHits.size(), rays.size());
    std::size_t wrongCount = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
        wrongCount += (anyHits[i].triangle == kMiss) != (expected[i].triangle == kMiss);
    EXPECT_LE(wrongCount, kLostRaysAllowed);
}

INSTANTIATE_TEST_SUITE_P(Structures, EmbreeAgreement, testing::Values("uniform", "cloud", "nested"));

} // namespace
} // namespace rt
