// Welding, generated normals and merging, on surfaces small enough to know the answer.
#include "tests/unit/import_soup.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace rt {
namespace {

using test::makeSoup;
using test::makeSphere;
using test::Repaired;

Repaired repair(const SceneSoup& soup, double creaseDegrees = 45.0) {
    return test::repair(soup, {.creaseDegrees = creaseDegrees});
}

SceneSoup makeCube() {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
    return makeSoup(corners, {{0, 2, 3},
                              {0, 3, 1},
                              {4, 5, 7},
                              {4, 7, 6},
                              {0, 1, 5},
                              {0, 5, 4},
                              {2, 6, 7},
                              {2, 7, 3},
                              {0, 4, 6},
                              {0, 6, 2},
                              {1, 3, 7},
                              {1, 7, 5}});
}

glm::vec3 faceNormal(const Mesh& mesh, std::size_t triangle) {
    const glm::uvec3 t = mesh.triangles[triangle];
    return glm::normalize(
        glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

TEST(ImportNormals, CubeHasSharpEdgesAtTheDefaultCrease) {
    const Repaired cube = repair(makeCube());
    EXPECT_EQ(cube.surface.weld.positions.size(), 8u);
    ASSERT_EQ(cube.mesh.positions.size(), 24u);
    for (std::size_t t = 0; t < 12; ++t)
        for (int corner = 0; corner < 3; ++corner)
            EXPECT_EQ(cube.mesh.normals[cube.mesh.triangles[t][corner]], faceNormal(cube.mesh, t));
}

TEST(ImportNormals, CubeIsRoundWhenNoEdgeIsACrease) {
    const Repaired cube = repair(makeCube(), 100.0);
    ASSERT_EQ(cube.mesh.positions.size(), 8u);
    // Weighting by angle makes up for the faces that have two triangles at a corner.
    for (std::size_t v = 0; v < 8; ++v)
        EXPECT_GT(glm::dot(cube.mesh.normals[v], glm::normalize(cube.mesh.positions[v] - 0.5f)), 0.99999f);
}

TEST(ImportNormals, SphereIsSmoothAndItsCornersShareVertices) {
    const Repaired sphere = repair(makeSphere(4));
    EXPECT_TRUE(sphere.ledger.empty());
    EXPECT_EQ(sphere.surface.figures.components, 1u);
    EXPECT_EQ(sphere.surface.figures.closedComponents, 1u);
    ASSERT_EQ(sphere.mesh.positions.size(), 1026u); // 4 * 4^4 + 2: as Euler has it
    for (std::size_t v = 0; v < sphere.mesh.positions.size(); ++v)
        EXPECT_GT(glm::dot(sphere.mesh.normals[v], sphere.mesh.positions[v]), 0.999f);
}

TEST(ImportNormals, NegativeZeroWeldsWithZero) {
    const SceneSoup soup =
        makeSoup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}, {0, 1, -0.0f}, {-1, 0, 0}},
                 {{0, 1, 2}, {3, 4, 5}});
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.surface.weld.positions.size(), 4u);
    EXPECT_EQ(repaired.mesh.positions.size(), 4u);
}

TEST(ImportNormals, ThreeFacesAtAnEdgeAreAllKeptInOrder) {
    const SceneSoup soup =
        makeSoup({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.ledger[Defect::NonManifold].count, 3u);
    ASSERT_EQ(repaired.mesh.triangles.size(), 3u);
    for (std::size_t t = 0; t < 3; ++t)
        for (int corner = 0; corner < 3; ++corner) {
            EXPECT_EQ(repaired.mesh.positions[repaired.mesh.triangles[t][corner]],
                      soup.positions[soup.triangles[t][corner]]);
            EXPECT_EQ(repaired.mesh.normals[repaired.mesh.triangles[t][corner]],
                      faceNormal(repaired.mesh, t));
        }
}

TEST(ImportNormals, SecondFaceOfAnotherMaterialIsKeptAndShadedLikeTheFirst) {
    SceneSoup soup = makeSphere(2);
    soup.triangles.push_back(soup.triangles[5]);
    soup.triangleMaterial.push_back(1);
    soup.origins.push_back({0, 128});
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.ledger[Defect::NonManifold].count, 5u); // the two and their three neighbours
    EXPECT_EQ(repaired.mesh.triangles.back(), repaired.mesh.triangles[5]);
    EXPECT_EQ(repaired.mesh.positions.size(), repair(makeSphere(2)).mesh.positions.size());
}

TEST(ImportNormals, FacesWithoutAreaGoButDoNotCutTheSurface) {
    // A strip that bends along x = 1, where one side has a vertex in the middle and the other has a face
    // without area instead.
    const SceneSoup soup =
        makeSoup({{0, 0, 0}, {1, 0, 0.1f}, {1, 1, 0.1f}, {1, 2, 0.1f}, {0, 2, 0}, {2, 1, 0}},
                 {{0, 1, 3}, {0, 3, 4}, {1, 2, 3}, {1, 5, 2}, {2, 5, 3}, {0, 0, 1}});
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.ledger[Defect::NoArea].count, 2u);
    ASSERT_EQ(repaired.mesh.triangles.size(), 4u);
    EXPECT_EQ(repaired.mesh.normals[repaired.mesh.triangles[0].y],
              repaired.mesh.normals[repaired.mesh.triangles[2].x]);
}

TEST(ImportNormals, NormalsDoNotOverflowOrUnderflowWithTheScale) {
    for (const float scale : {1e-30f, 1e30f}) {
        SceneSoup sphere = makeSphere(2);
        for (glm::vec3& position : sphere.positions) position *= scale;
        const Repaired repaired = repair(sphere);
        EXPECT_TRUE(repaired.ledger.empty());
        for (std::size_t v = 0; v < repaired.mesh.positions.size(); ++v)
            EXPECT_GT(glm::dot(repaired.mesh.normals[v], repaired.mesh.positions[v] / scale), 0.99f);
    }
}

TEST(ImportNormals, FileNormalsAndTexcoordsSeparateVerticesAndUnusedVerticesGo) {
    SceneSoup soup = makeSoup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {0, -1, 0}},
                              {{0, 1, 2}, {5, 4, 6}});
    const glm::vec3 up(0, 0, 1), tilted = glm::normalize(glm::vec3(0, 1, 1));
    soup.normals = {up, up, up, up, tilted, up, glm::vec3(0)};
    soup.texcoords = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 0}, {0.5f, 0}, {0, 0}};
    const Repaired repaired = repair(soup);
    ASSERT_EQ(repaired.mesh.positions.size(), 6u); // both ends of the shared edge are split, (5,5,5) is gone
    EXPECT_EQ(countMissingNormals(soup), 1u);
    EXPECT_EQ(repaired.mesh.normals[repaired.mesh.triangles[1].y], tilted);
    EXPECT_EQ(repaired.mesh.texcoords[repaired.mesh.triangles[1].x], glm::vec2(0.5f, 0));
    EXPECT_EQ(repaired.mesh.normals[repaired.mesh.triangles[1].z], up); // generated
}

} // namespace
} // namespace rt
