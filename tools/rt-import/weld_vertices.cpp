#include "tools/rt-import/weld_vertices.h"

#include "tools/rt-import/index_table.h"

namespace rt {
namespace {

std::uint64_t hashOf(std::uint64_t seed, const glm::vec3& v) {
    return mixHash(mixHash(mixHash(seed, hashBits(v.x)), hashBits(v.y)), hashBits(v.z));
}

bool hasNormal(const SceneSoup& soup, std::uint32_t vertex) {
    return !soup.normals.empty() && soup.normals[vertex] != glm::vec3(0.0f);
}

} // namespace

Weld weldPositions(const SceneSoup& soup) {
    constexpr std::uint32_t kUnseen = 0xFFFFFFFFu;
    Weld weld;
    IndexTable table(soup.positions.size());
    std::vector<std::uint32_t> weldedOf(soup.positions.size(), kUnseen);
    weld.positions.reserve(soup.positions.size());
    weld.triangles.reserve(soup.triangles.size());
    for (const glm::uvec3& triangle : soup.triangles) {
        glm::uvec3 welded;
        for (int corner = 0; corner < 3; ++corner) {
            std::uint32_t& index = weldedOf[triangle[corner]];
            if (index == kUnseen) {
                const glm::vec3 position = soup.positions[triangle[corner]] + 0.0f; // turns -0 into +0
                const auto next = static_cast<std::uint32_t>(weld.positions.size());
                index = table.findOrInsert(hashOf(0, position), next, [&](std::uint32_t other) {
                    return weld.positions[other] == position;
                });
                if (index == next) weld.positions.push_back(position);
            }
            welded[corner] = index;
        }
        weld.triangles.push_back(welded);
    }
    return weld;
}

Mesh mergeCorners(const SceneSoup& soup, const Weld& weld, std::span<const glm::vec3> cornerNormals) {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> texcoords;
    std::vector<glm::uvec3> triangles(soup.triangles.size());
    std::vector<std::uint32_t> weldedOf; // of each new vertex
    IndexTable table(soup.triangles.size() * 3);
    const bool textured = !soup.texcoords.empty();
    for (std::size_t corner = 0; corner < soup.triangles.size() * 3; ++corner) {
        const auto k = static_cast<int>(corner % 3);
        const std::uint32_t vertex = soup.triangles[corner / 3][k];
        const std::uint32_t welded = weld.triangles[corner / 3][k];
        const glm::vec3 normal = hasNormal(soup, vertex) ? soup.normals[vertex] : cornerNormals[corner];
        const glm::vec2 texcoord = textured ? soup.texcoords[vertex] : glm::vec2(0.0f);
        const std::uint64_t hash =
            hashOf(mixHash(mixHash(welded, hashBits(texcoord.x)), hashBits(texcoord.y)), normal);
        const auto next = static_cast<std::uint32_t>(positions.size());
        const std::uint32_t index = table.findOrInsert(hash, next, [&](std::uint32_t other) {
            return weldedOf[other] == welded && normals[other] == normal &&
                   (!textured || texcoords[other] == texcoord);
        });
        triangles[corner / 3][k] = index;
        if (index != next) continue;
        weldedOf.push_back(welded);
        positions.push_back(weld.positions[welded]);
        normals.push_back(normal);
        if (textured) texcoords.push_back(texcoord);
    }
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
    mesh.texcoords = std::move(texcoords);
    mesh.triangles = std::move(triangles);
    return mesh;
}

std::uint64_t countMissingNormals(const SceneSoup& soup) {
    std::uint64_t count = 0;
    for (const glm::uvec3& t : soup.triangles)
        for (int corner = 0; corner < 3; ++corner) count += !hasNormal(soup, t[corner]);
    return count;
}

} // namespace rt
