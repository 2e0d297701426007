// Rays that leave surfaces in pictures: none may hit the triangle that it leaves (acne), none may get through
// a closed surface (light leaks), at any scale and any distance from the origin.
#include "tests/gpu/render_fixture.h"
#include "tests/stress/closed_mesh.h"
#include "tests/stress/stress_fixture.h"
#include "tests/support/make_mesh.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

namespace rt {
namespace {

using test::ClosedMesh;
using test::kPlacements;
using test::Placement;

constexpr unsigned kBounces = 16;

Mesh withOptics(Mesh mesh, float reflectivity, float transmission) {
    Material material = test::greyMaterial();
    material.reflection.y = 0.0f;
    material.reflection.w = reflectivity;
    material.transmission.x = transmission;
    mesh.materials = std::vector<Material>{material};
    return mesh;
}

// From the eye to the sum of what the tests of this file want to know.
struct Outcome {
    std::uint64_t secondaryRays = 0;
    std::uint64_t selfHits = 0;
    std::uint64_t otherPixels = 0; ///< that have not the colour that all should have, if there is one
};

class SecondaryRays : public test::OnGpu {
protected:
    static void TearDownTestSuite() {
        fmt::print("secondary rays in all: {}, of them {} hit the triangle that they left\n",
                   total_.secondaryRays, total_.selfHits);
        OnGpu::TearDownTestSuite();
    }

    static Outcome render(const std::string& name, const Atlas& atlas, const CameraPose& pose,
                          const glm::vec3& background,
                          const std::optional<glm::vec3>& expected = std::nullopt) {
        SceneFeatures features = renderFeatures(atlas, {.maxDepth = kBounces, .lights = test::kTwoLights});
        features.countWork = 1;
        features.software = context->device().software;
        const glm::uvec2 size(side());
        const test::Picture picture = test::renderPicture(
            *context, atlas, {features, pose, size, background, 0.0f}, limits().resources);
        Outcome outcome;
        for (std::size_t i = 0; i < picture.counters.size(); ++i) {
            outcome.secondaryRays += picture.counters[i].x - 1;
            outcome.selfHits += picture.counters[i].w;
            if (!expected) continue;
            const glm::vec3 apart = glm::abs(glm::vec3(picture.pixels.colors[i]) - *expected);
            outcome.otherPixels += std::max({apart.x, apart.y, apart.z}) <= 1e-4f ? 0 : 1;
        }
        fmt::print("{}: {} of {} secondary rays hit the triangle that they left\n", name, outcome.selfHits,
                   outcome.secondaryRays);
        EXPECT_EQ(outcome.selfHits, 0u) << name;
        total_.secondaryRays += outcome.secondaryRays;
        total_.selfHits += outcome.selfHits;
        return outcome;
    }

    static CameraPose poseInside(const ClosedMesh& closed) {
        CameraPose pose;
        pose.eye = glm::dvec3(closed.insides.front());
        pose.lookAt = glm::dvec3(closed.mesh.positions[closed.mesh.triangles[7].x]);
        pose.up = {0.31, 0.9, -0.2};
        pose.fovDegrees = 100.0;
        return pose;
    }

    static CameraPose poseOutside(const Atlas& atlas) {
        CameraRequest request;
        request.fovDegrees = 30.0;
        return placeCamera(request, test::boundsOfAtlas(atlas), 1.0);
    }

    static Atlas atlasOf(const Mesh& mesh) { return test::makeAtlas(mesh, kStructureNested, {12, 11, 10}); }

    // A ray for each bounce of each pixel, so that a picture has about raysPerCase() of them.
    static unsigned side() {
        return static_cast<unsigned>(
            std::clamp(std::sqrt(double(test::raysPerCase()) / kBounces), 64.0, 4096.0));
    }

    static std::uint64_t pixelCount() { return std::uint64_t(side()) * side(); }

private:
    static inline Outcome total_;
};

// A convex mirror shows nothing but the background: a mirrored ray that hits anything is acne.
TEST_F(SecondaryRays, AConvexMirrorDoesNotSeeItself) {
    for (const Placement& placement : kPlacements)
        for (const Mesh& mesh : {test::makeSphere(4), test::makeCube()}) {
            const Atlas atlas =
                atlasOf(withOptics(test::moved(mesh, placement.scale, placement.offset), 1.0f, 0.0f));
            const glm::vec3 background(0.25f, 0.5f, 0.75f);
            const Outcome outcome = render(
                fmt::format("convex mirror of {} triangles, {}", mesh.triangles.size(), placement.name),
                atlas, poseOutside(atlas), background, background);
            EXPECT_GT(outcome.secondaryRays, pixelCount() / 8);
            EXPECT_EQ(outcome.otherPixels, 0u) << placement.name;
        }
}

// Inside a closed mirror no light of the background is ever seen, however often rays are mirrored.
TEST_F(SecondaryRays, NoLightGetsIntoAClosedMirror) {
    for (const Placement& placement : kPlacements)
        for (const ClosedMesh& closed : {test::closedSphere(), test::closedTorus()}) {
            ClosedMesh placed = placement.of(closed);
            placed.mesh = withOptics(placed.mesh, 1.0f, 0.0f);
            const Outcome outcome = render("inside a mirror, " + placed.name, atlasOf(placed.mesh),
                                           poseInside(placed), glm::vec3(1.0f), glm::vec3(0.0f));
            EXPECT_EQ(outcome.secondaryRays, pixelCount() * kBounces) << placed.name;
            EXPECT_EQ(outcome.otherPixels, 0u) << placed.name;
        }
}

// Mirrored, refracted and shadow rays of one picture.
TEST_F(SecondaryRays, GlassAndShadowsHaveNoAcne) {
    for (const Placement& placement : kPlacements)
        for (const Mesh& mesh : {test::makeSphere(4), test::makeTorus(1.0f, 0.4f, 40, 24)}) {
            const Atlas atlas =
                atlasOf(withOptics(test::moved(mesh, placement.scale, placement.offset), 0.3f, 0.5f));
            const Outcome outcome =
                render(fmt::format("glass of {} triangles, {}", mesh.triangles.size(), placement.name), atlas,
                       poseOutside(atlas), glm::vec3(0.5f));
            EXPECT_GT(outcome.secondaryRays, pixelCount()) << placement.name;
        }
}

// Where a vertex is the origin of atlas space, its error box has no size, but those of the other corners
// have.
TEST_F(SecondaryRays, AVertexAtTheOriginHasNoAcne) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 12; ++i) {
        const auto onRing = [](int k) {
            const double angle = 0.5236 * k + 0.1;
            return glm::vec3(std::cos(angle), 0.37 + 0.1 * (k % 2), std::sin(angle));
        };
        std::array triangle{glm::vec3(0.0f), onRing(i), onRing((i + 1) % 12)};
        std::rotate(triangle.begin(), triangle.begin() + i % 3, triangle.end()); // the origin anywhere
        for (const float side : {1.0f, -1.0f})
            for (const glm::vec3& corner : triangle) corners.push_back(side * corner);
    }
    const Atlas atlas = atlasOf(withOptics(test::makeTriangles(corners), 0.5f, 0.4f));
    for (const double fovDegrees : {30.0, 1e-1, 1e-3, 1e-5, 1e-7}) {
        CameraPose pose = poseOutside(atlas);
        pose.eye = {0.7, 1.9, 0.4};
        pose.lookAt = {};
        pose.fovDegrees = fovDegrees;
        const Outcome outcome = render(fmt::format("cones that meet at the origin, {} degrees", fovDegrees),
                                       atlas, pose, glm::vec3(0.5f));
        EXPECT_GT(outcome.secondaryRays, pixelCount()) << fovDegrees << " degrees";
    }
}

TEST_F(SecondaryRays, AModelHasNoAcne) {
    const std::string path = test::scenePath("models/statues/bun_zipper.ply");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const ClosedMesh bunny = test::closedModel("bunny", path);
    for (const auto& [reflectivity, transmission] : {std::pair(0.8f, 0.0f), std::pair(0.2f, 0.7f)}) {
        const Atlas atlas = atlasOf(withOptics(bunny.mesh, reflectivity, transmission));
        const Outcome outcome =
            render(fmt::format("bunny, reflectivity {}, transmission {}", reflectivity, transmission), atlas,
                   poseOutside(atlas), glm::vec3(0.5f));
        EXPECT_GT(outcome.secondaryRays, pixelCount() / 8) << "transmission " << transmission;
    }
}

} // namespace
} // namespace rt
