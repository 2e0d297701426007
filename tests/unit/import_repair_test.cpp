// What the repair does to faces and vertices, on surfaces small enough to know the answer.
#include "common/error.h"
#include "tests/unit/import_soup.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <set>

namespace rt {
namespace {

using test::makeSoup;
using test::makeSphere;
using test::repair;
using test::Repaired;
using testing::ElementsAre;

void turn(SceneSoup& soup, std::size_t triangle) {
    std::swap(soup.triangles[triangle].y, soup.triangles[triangle].z);
}

// n x n squares of side 1/n in the plane z = 0, facing +z.
SceneSoup makeGrid(std::uint32_t n) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            positions.push_back(glm::vec3(x, y, 0) / static_cast<float>(n));
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t at = y * (n + 1) + x;
            triangles.emplace_back(at, at + 1, at + n + 2);
            triangles.emplace_back(at, at + n + 2, at + n + 1);
        }
    return makeSoup(std::move(positions), std::move(triangles));
}

double areaOf(const Mesh& mesh) {
    double area = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

TEST(ImportRepair, RepeatedFacesGoWhateverTheirFirstCorner) {
    SceneSoup soup = makeSoup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                              {{0, 1, 2}, {1, 2, 0}, {2, 0, 3}, {0, 2, 1}, {0, 1, 2}});
    soup.triangleMaterial = {0, 0, 0, 0, 1};
    const Repaired repaired = repair(soup);
    EXPECT_THAT(repaired.ledger[Defect::Duplicates].first, ElementsAre(FaceOrigin{0, 1}, FaceOrigin{0, 2}));
    EXPECT_EQ(repaired.mesh.triangles.size(), 3u); // the back and the other material stay
    EXPECT_THAT(repaired.mesh.triangleMaterial, ElementsAre(0, 0, 1));
}

TEST(ImportRepair, FacesWithOtherTextureCoordinatesAreNoRepeats) {
    SceneSoup soup = makeSoup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}, {3, 1, 2}});
    soup.texcoords = {{0, 0}, {1, 0}, {0, 1}, {0.5f, 0}};
    EXPECT_EQ(repair(soup).ledger[Defect::Duplicates].count, 0u);
    soup.texcoords[3] = {0, 0};
    EXPECT_EQ(repair(soup).ledger[Defect::Duplicates].count, 1u);
}

TEST(ImportRepair, TheFewFacesAreTurnedAsTheManyAre) {
    SceneSoup soup = makeSphere(2);
    for (const std::size_t triangle : {0, 17, 18, 90}) turn(soup, triangle);
    const Repaired repaired = repair(soup), sound = repair(makeSphere(2));
    EXPECT_THAT(repaired.ledger[Defect::Turned].first,
                ElementsAre(FaceOrigin{0, 0}, FaceOrigin{0, 17}, FaceOrigin{0, 18}, FaceOrigin{0, 90}));
    for (const glm::uvec3& t : repaired.mesh.triangles) {
        const glm::vec3 a = repaired.mesh.positions[t.x], b = repaired.mesh.positions[t.y],
                        c = repaired.mesh.positions[t.z];
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0.0f);
    }
    EXPECT_EQ(repaired.mesh.positions.size(), sound.mesh.positions.size());
    EXPECT_EQ(repaired.surface.figures.closedComponents, 1u);
}

TEST(ImportRepair, CoincidentFacesAreNoNeighbours) { // a square, and another material on it
    SceneSoup soup =
        makeSoup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}});
    soup.triangleMaterial = {0, 0, 1, 1};
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.mesh.triangles.size(), 4u);
    EXPECT_EQ(repaired.ledger[Defect::Turned].count, 0u);
    for (const glm::vec3& normal : repaired.mesh.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

TEST(ImportRepair, InsideOutIsNoDefect) { // it may be a room
    SceneSoup soup = makeSphere(1);
    for (std::size_t triangle = 0; triangle < soup.triangles.size(); ++triangle) turn(soup, triangle);
    EXPECT_TRUE(repair(soup).ledger.empty());
}

TEST(ImportRepair, AMoebiusStripIsCutOnce) {
    constexpr std::uint32_t kSteps = 24;
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < kSteps; ++i) {
        const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / kSteps;
        const glm::vec3 out(std::cos(angle), std::sin(angle), 0.0f);
        const glm::vec3 across = 0.3f * (std::cos(angle / 2) * out + glm::vec3(0, 0, std::sin(angle / 2)));
        positions.insert(positions.end(), {out - across, out + across});
        const bool last = i + 1 == kSteps;
        const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
        triangles.insert(triangles.end(), {{a, b, c}, {b, d, c}});
    }
    const Repaired repaired = repair(makeSoup(positions, triangles));
    EXPECT_EQ(repaired.mesh.triangles.size(), 2 * kSteps);
    EXPECT_EQ(repaired.surface.figures.nonManifoldEdges, 1u);
    EXPECT_EQ(repaired.surface.figures.boundaryEdges, 2 * kSteps);
    EXPECT_EQ(repaired.surface.figures.components, 1u);
}

TEST(ImportRepair, BoxesThatShareAnEdgeStayTwoClosedBodies) {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 8; ++i) positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
    const std::vector<glm::uvec3> box{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    std::vector<glm::uvec3> triangles = box;
    for (int i = 0; i < 8; ++i)
        positions.push_back(positions[static_cast<std::size_t>(i)] + glm::vec3(1, 1, 0));
    for (const glm::uvec3& t : box) triangles.push_back(t + 8u);
    const Repaired repaired = repair(makeSoup(positions, triangles));
    EXPECT_EQ(repaired.surface.figures.nonManifoldEdges, 1u);
    EXPECT_EQ(repaired.ledger[Defect::NonManifold].count, 4u);
    EXPECT_EQ(repaired.surface.figures.components, repaired.surface.figures.closedComponents);
    EXPECT_EQ(repaired.mesh.triangles.size(), 24u);
    EXPECT_EQ(repaired.surface.figures.boundaryEdges, 0u);
}

TEST(ImportRepair, BothSidesOfASheetStaySmooth) {
    SceneSoup sphere = makeSphere(3); // each face and its back, one behind the other
    SceneSoup soup = makeSoup(sphere.positions, {});
    for (const glm::uvec3& t : sphere.triangles) {
        soup.triangles.insert(soup.triangles.end(), {t, {t.x, t.z, t.y}});
        soup.triangleMaterial.insert(soup.triangleMaterial.end(), {0, 0});
        soup.origins.insert(soup.origins.end(), {{0, 0}, {0, 0}});
    }
    const Repaired repaired = repair(soup);
    EXPECT_EQ(repaired.surface.figures.components, 2u);
    for (std::size_t v = 0; v < repaired.mesh.positions.size(); ++v)
        EXPECT_GT(std::abs(glm::dot(repaired.mesh.normals[v], repaired.mesh.positions[v])), 0.99f);
}

TEST(ImportRepair, ThousandsOfFacesAtOneEdgeTakeNoTime) {
    std::vector<glm::vec3> positions{{0, 0, 0}, {0, 0, 1}};
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        positions.emplace_back(1, i, 0);
        triangles.push_back(i % 2 ? glm::uvec3(0, 1, i + 2) : glm::uvec3(1, 0, i + 2));
    }
    const Repaired repaired = repair(makeSoup(positions, triangles));
    EXPECT_EQ(repaired.mesh.triangles.size(), 100'000u);
    EXPECT_EQ(repaired.surface.figures.nonManifoldEdges, 1u);
}

TEST(ImportRepair, WeldJoinsWhatIsWithinItsDistance) {
    SceneSoup soup = makeGrid(4);
    SceneSoup apart = makeSoup({}, {});
    for (const glm::uvec3& t : soup.triangles) { // every triangle has corners of its own, a little off
        const auto first = static_cast<std::uint32_t>(apart.positions.size());
        for (int k = 0; k < 3; ++k)
            apart.positions.push_back(soup.positions[t[k]] +
                                      glm::vec3(0, 0, 1e-3f * static_cast<float>(first % 7)));
        apart.triangles.emplace_back(first, first + 1, first + 2);
    }
    apart.triangleMaterial = soup.triangleMaterial;
    apart.origins = soup.origins;
    EXPECT_GT(repair(apart).surface.figures.components, 10u);
    const Repaired welded = repair(apart, {.weldDistance = 0.01});
    EXPECT_EQ(welded.surface.figures.components, 1u);
    EXPECT_EQ(welded.surface.weld.positions.size(), 25u);
    EXPECT_EQ(welded.surface.weld.movedPositions + 25u, repair(apart).surface.weld.positions.size());
    const Repaired collapsed = repair(apart, {.weldDistance = 0.26}); // as long as the squares' sides
    EXPECT_GT(collapsed.ledger[Defect::NoArea].count, 0u);
}

TEST(ImportRepair, DecimatedSphereStaysASphere) {
    const Repaired repaired = repair(makeSphere(5), {.decimateRatio = 0.1}); // of 8192 triangles
    EXPECT_EQ(repaired.surface.decimatedFrom, 8192u);
    EXPECT_LE(repaired.mesh.triangles.size(), 819u);
    EXPECT_GE(repaired.mesh.triangles.size(), 817u);
    EXPECT_EQ(repaired.surface.figures.closedComponents, 1u);
    EXPECT_NEAR(areaOf(repaired.mesh), 4.0 * std::numbers::pi, 0.02 * 4.0 * std::numbers::pi);
    for (std::size_t v = 0; v < repaired.mesh.positions.size(); ++v) {
        EXPECT_NEAR(glm::length(repaired.mesh.positions[v]), 1.0f, 1e-5f); // vertices do not move
        EXPECT_GT(glm::dot(repaired.mesh.normals[v], repaired.mesh.positions[v]), 0.98f);
    }
}

TEST(ImportRepair, ProgressGrowsToItsEnd) {
    SceneSoup soup = makeSphere(5);
    Ledger ledger;
    std::vector<double> parts;
    repairSoup(soup, {.decimateRatio = 0.1}, "test", ledger, [&](double part) { parts.push_back(part); });
    EXPECT_GE(parts.size(), 5u);
    EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
    EXPECT_LE(parts.back(), 1.0);
}

TEST(ImportRepair, DecimatedSquareKeepsItsBorder) {
    const Repaired repaired = repair(makeGrid(40), {.maxTriangles = 20});
    EXPECT_LE(repaired.mesh.triangles.size(), 20u);
    EXPECT_NEAR(areaOf(repaired.mesh), 1.0, 1e-6);
}

TEST(ImportRepair, DecimationKeepsSeamsOfTexturesAndMaterials) {
    constexpr std::uint32_t n = 20;
    SceneSoup soup = makeGrid(n);
    for (const glm::vec3& p : soup.positions) soup.texcoords.emplace_back(p.x, p.y);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) // the upper half has coordinates of its own
        for (int k = 0; k < 3 && t >= soup.triangles.size() / 2; ++k) {
            const std::uint32_t vertex = soup.triangles[t][k];
            soup.positions.push_back(soup.positions[vertex]);
            soup.texcoords.push_back(soup.texcoords[vertex] + glm::vec2(5, 0));
            soup.triangles[t][k] = static_cast<std::uint32_t>(soup.positions.size() - 1);
            soup.triangleMaterial[t] = 1;
        }
    const Repaired repaired = repair(soup, {.decimateRatio = 0.2});
    EXPECT_LE(repaired.mesh.triangles.size(), 160u);
    double upper = 0.0;
    for (std::size_t t = 0; t < repaired.mesh.triangles.size(); ++t) {
        const bool isUpper = repaired.mesh.triangleMaterial[t] == 1;
        Mesh one = repaired.mesh;
        one.triangles = std::vector<glm::uvec3>{repaired.mesh.triangles[t]};
        if (isUpper) upper += areaOf(one);
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t v = repaired.mesh.triangles[t][k];
            const glm::vec2 shift(isUpper ? 5.0f : 0.0f, 0.0f);
            EXPECT_LT(
                glm::distance(repaired.mesh.texcoords[v], glm::vec2(repaired.mesh.positions[v]) + shift),
                1e-6f);
        }
    }
    EXPECT_NEAR(upper, 0.5, 1e-6);
}

TEST(ImportRepair, WhatCannotBeDecimatedEnoughIsRefused) {
    SceneSoup soup = makeSoup({}, {}); // triangles that no edge joins
    for (std::uint32_t i = 0; i < 10; ++i) {
        const auto x = static_cast<float>(2 * i);
        soup.positions.insert(soup.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
        soup.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        soup.triangleMaterial.push_back(0);
        soup.origins.push_back({0, i});
    }
    EXPECT_EQ(repair(soup, {.decimateRatio = 0.5}).mesh.triangles.size(), 10u); // asks for what can be had
    try {
        repair(soup, {.maxTriangles = 5});
        FAIL() << "more triangles than allowed";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::LimitExceeded);
        EXPECT_THAT(error.what(), testing::HasSubstr("10 triangles are left"));
    }
}

TEST(ImportRepair, TheLedgerNamesMeshesOnceInARow) {
    Ledger ledger;
    const std::uint32_t a = ledger.addMesh("a"), none = ledger.addMesh(""), b = ledger.addMesh("b");
    EXPECT_TRUE(ledger.empty());
    for (const FaceOrigin origin : {FaceOrigin{a, 3}, {a, 4}, {a, 3}, {none, 7}, {b, 0}, {b, 1}, {b, 2}})
        ledger.add(Defect::NoArea, origin);
    EXPECT_THAT(ledger.lines(),
                ElementsAre("faces without area: 7 dropped (first: face 3, 4 of mesh 'a', face "
                            "7, face 0, 1 of mesh 'b')"));
}

} // namespace
} // namespace rt
