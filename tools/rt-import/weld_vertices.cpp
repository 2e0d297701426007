#include "tools/rt-import/weld_vertices.h"

#include "tools/rt-import/index_table.h"

#include <glm/geometric.hpp>

#include <array>
#include <unordered_map>
#include <utility>

namespace rt {
namespace {

std::uint64_t hashOf(std::uint64_t seed, const glm::vec3& v) {
    return mixHash(mixHash(mixHash(seed, hashBits(v.x)), hashBits(v.y)), hashBits(v.z));
}

bool hasNormal(const SceneSoup& soup, std::uint32_t vertex) {
    return !soup.normals.empty() && soup.normals[vertex] != glm::vec3(0.0f);
}

Weld weldEqual(const SceneSoup& soup) {
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

// The welded positions so far, in boxes of the distance's size.
class PositionGrid {
public:
    explicit PositionGrid(double distance) : distance_(distance) {}

    /// The first position within the distance, or the new one.
    std::uint32_t findOrAdd(const glm::vec3& position, std::vector<glm::vec3>& positions) {
        const auto next = static_cast<std::uint32_t>(positions.size());
        const glm::dvec3 box = glm::floor(glm::dvec3(position) / distance_);
        std::uint32_t found = next;
        for (int i = 0; i < 27; ++i) {
            const auto entry = boxes_.find(keyOf(box + glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
            if (entry == boxes_.end()) continue;
            for (const std::uint32_t other : entry->second)
                if (other < found &&
                    glm::distance(glm::dvec3(positions[other]), glm::dvec3(position)) <= distance_)
                    found = other;
        }
        if (found != next) return found;
        positions.push_back(position);
        boxes_[keyOf(box)].push_back(next);
        return next;
    }

private:
    using Key = std::array<double, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const {
            std::uint64_t hash = 0;
            for (const double number : key) {
                const auto bits = std::bit_cast<std::uint64_t>(number);
                hash = mixHash(mixHash(hash, static_cast<std::uint32_t>(bits)),
                               static_cast<std::uint32_t>(bits >> 32));
            }
            return hash;
        }
    };
    static Key keyOf(const glm::dvec3& box) { return {box.x + 0.0, box.y + 0.0, box.z + 0.0}; } // no -0

    double distance_;
    std::unordered_map<Key, std::vector<std::uint32_t>, Hash> boxes_;
};

} // namespace

Weld weldPositions(const SceneSoup& soup, double distance) {
    Weld weld = weldEqual(soup);
    if (!(distance > 0.0)) return weld;
    PositionGrid grid(distance);
    const std::vector<glm::vec3> apart = std::exchange(weld.positions, {});
    std::vector<std::uint32_t> weldedOf;
    weldedOf.reserve(apart.size());
    for (const glm::vec3& position : apart) weldedOf.push_back(grid.findOrAdd(position, weld.positions));
    for (glm::uvec3& t : weld.triangles) t = {weldedOf[t.x], weldedOf[t.y], weldedOf[t.z]};
    weld.movedPositions = apart.size() - weld.positions.size();
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
