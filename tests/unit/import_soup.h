#pragma once
#include "tools/rt-import/repair_mesh.h"

#include <glm/geometric.hpp>

#include <array>
#include <vector>

namespace rt::test {

struct Repaired {
    Mesh mesh;
    RepairedSurface surface;
    Ledger ledger;
};

inline SceneSoup makeSoup(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
    SceneSoup soup;
    soup.triangleMaterial.assign(triangles.size(), 0);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) soup.origins.push_back({0, i});
    soup.positions = std::move(positions);
    soup.triangles = std::move(triangles);
    return soup;
}

inline Repaired repair(SceneSoup soup, const RepairOptions& options = {}) {
    Repaired result;
    result.ledger.addMesh("m");
    result.surface = repairSoup(soup, options, "test", result.ledger, [](double) {});
    result.mesh = mergeCorners(soup, result.surface.weld, result.surface.cornerNormals);
    result.mesh.triangleMaterial = std::move(soup.triangleMaterial);
    return result;
}

// An octahedron with every face cut into four, `levels` times over, on the unit sphere; no corner is shared.
inline SceneSoup makeSphere(int levels) {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    std::vector<std::array<glm::vec3, 3>> faces{{x, y, z},  {y, -x, z},  {-x, -y, z},  {-y, x, z},
                                                {y, x, -z}, {-x, y, -z}, {-y, -x, -z}, {x, -y, -z}};
    for (int level = 0; level < levels; ++level) {
        std::vector<std::array<glm::vec3, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const glm::vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c),
                            ca = glm::normalize(c + a);
            for (const auto& face : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(face);
        }
        faces = std::move(finer);
    }
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const auto& face : faces) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        positions.insert(positions.end(), face.begin(), face.end());
        triangles.emplace_back(first, first + 1, first + 2);
    }
    return makeSoup(std::move(positions), std::move(triangles));
}

} // namespace rt::test
