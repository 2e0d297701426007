#include "tools/rt-import/surface_topology.h"

#include "tools/rt-import/index_table.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <numeric>

namespace rt {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

// A side is numbered 3 * triangle + k and goes from corner k to the next.
std::uint32_t nextCorner(std::uint32_t side) {
    return side % 3 == 2 ? side - 2 : side + 1;
}

class Edges {
public:
    explicit Edges(std::span<const glm::uvec3> triangles);

    std::size_t count() const { return first_.size() - 1; }
    /// Sides of the edge, in the order of the triangles.
    std::span<const std::uint32_t> sidesOf(std::size_t edge) const {
        return std::span(sides_).subspan(first_[edge], first_[edge + 1] - first_[edge]);
    }
    std::uint32_t edgeOf(std::uint32_t side) const { return edgeOf_[side]; }
    /// Whether the side goes from its edge's lower vertex to the higher one.
    bool isForward(std::uint32_t side) const { return vertexAt(side) < vertexAt(nextCorner(side)); }

    /// Whether one face covers the other, as a decal does.
    bool haveSameCorners(std::uint32_t a, std::uint32_t b) const {
        const auto has = [&](std::uint32_t v) { return glm::any(glm::equal(triangles_[b], glm::uvec3(v))); };
        return has(triangles_[a].x) && has(triangles_[a].y) && has(triangles_[a].z);
    }

private:
    std::uint32_t vertexAt(std::uint32_t corner) const {
        return triangles_[corner / 3][static_cast<int>(corner % 3)];
    }

    std::span<const glm::uvec3> triangles_;
    std::vector<std::uint32_t> edgeOf_, first_, sides_;
};

Edges::Edges(std::span<const glm::uvec3> triangles) : triangles_(triangles) {
    const auto sideCount = static_cast<std::uint32_t>(triangles.size() * 3);
    edgeOf_.resize(sideCount);
    IndexTable table(sideCount);
    std::vector<std::uint32_t> firstSide;
    for (std::uint32_t side = 0; side < sideCount; ++side) {
        const auto [lo, hi] = std::minmax({vertexAt(side), vertexAt(nextCorner(side))});
        const auto next = static_cast<std::uint32_t>(firstSide.size());
        edgeOf_[side] = table.findOrInsert(mixHash(mixHash(0, lo), hi), next, [&](std::uint32_t edge) {
            const std::uint32_t other = firstSide[edge];
            return std::minmax({vertexAt(other), vertexAt(nextCorner(other))}) == std::pair(lo, hi);
        });
        if (edgeOf_[side] == next) firstSide.push_back(side);
    }
    first_.assign(firstSide.size() + 1, 0);
    for (const std::uint32_t edge : edgeOf_) ++first_[edge + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    sides_.resize(sideCount);
    std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
    for (std::uint32_t side = 0; side < sideCount; ++side) sides_[at[edgeOf_[side]]++] = side;
}

// Disjoint sets; a set's representative is its lowest member.
class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    std::uint32_t find(std::uint32_t member) {
        while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
        return member;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

// The one of the free sides whose face continues that of `side` best; the last of very many.
std::vector<std::uint32_t>::iterator bestOf(std::vector<std::uint32_t>& free, std::uint32_t side,
                                            std::span<const glm::vec3> faceNormals) {
    constexpr std::size_t kMostCompared = 64; // a file may join all of its faces at one edge
    if (free.size() > kMostCompared) return free.end() - 1;
    return std::max_element(free.begin(), free.end(), [&](std::uint32_t a, std::uint32_t b) {
        return glm::dot(faceNormals[side / 3], faceNormals[a / 3]) <
               glm::dot(faceNormals[side / 3], faceNormals[b / 3]);
    });
}

// For each side, the one of a neighbour that it is joined to, or kNone.
std::vector<std::uint32_t> joinSides(const Edges& edges, std::span<const glm::vec3> faceNormals) {
    std::vector<std::uint32_t> joined(faceNormals.size() * 3, kNone);
    std::vector<std::uint32_t> free;
    for (std::size_t edge = 0; edge < edges.count(); ++edge) {
        free.clear();
        for (const std::uint32_t side : edges.sidesOf(edge))
            if (!edges.isForward(side)) free.push_back(side);
        for (const std::uint32_t side : edges.sidesOf(edge)) {
            if (free.empty()) break;
            if (!edges.isForward(side)) continue;
            const auto best = bestOf(free, side, faceNormals);
            joined[side] = *best;
            joined[*best] = side;
            free.erase(best);
        }
    }
    return joined;
}

// Numbers the fans of faces at each vertex as vertices of their own, in the order of first use.
void splitVertices(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> joined,
                   SplitSurface& surface) {
    Sets corners(joined.size());
    for (std::uint32_t side = 0; side < joined.size(); ++side) {
        if (joined[side] == kNone || joined[side] < side) continue;
        corners.join(side, nextCorner(joined[side]));
        corners.join(nextCorner(side), joined[side]);
    }
    std::vector<std::uint32_t> numberOf(joined.size(), kNone);
    surface.triangles.resize(triangles.size());
    for (std::uint32_t corner = 0; corner < joined.size(); ++corner) {
        const auto k = static_cast<int>(corner % 3);
        std::uint32_t& number = numberOf[corners.find(corner)];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(surface.vertexOf.size());
            surface.vertexOf.push_back(triangles[corner / 3][k]);
        }
        surface.triangles[corner / 3][k] = number;
    }
}

void countComponents(std::span<const std::uint32_t> joined, SurfaceFigures& figures) {
    const std::size_t count = joined.size() / 3;
    Sets faces(count);
    for (std::uint32_t side = 0; side < joined.size(); ++side)
        if (joined[side] != kNone) faces.join(side / 3, joined[side] / 3);
    std::vector<bool> open(count, false);
    for (std::uint32_t side = 0; side < joined.size(); ++side)
        if (joined[side] == kNone) open[faces.find(side / 3)] = true;
    for (std::uint32_t face = 0; face < count; ++face) {
        if (faces.find(face) != face) continue;
        ++figures.components;
        figures.closedComponents += !open[face];
    }
}

void countEdges(const Edges& edges, std::span<const std::uint32_t> joined, SplitSurface& surface) {
    std::vector<bool> marked(joined.size() / 3, false);
    for (std::size_t edge = 0; edge < edges.count(); ++edge) {
        const std::span<const std::uint32_t> sides = edges.sidesOf(edge);
        surface.figures.boundaryEdges += sides.size() == 1;
        if (sides.size() < 2 || (sides.size() == 2 && joined[sides[0]] != kNone)) continue;
        ++surface.figures.nonManifoldEdges;
        for (const std::uint32_t side : sides) marked[side / 3] = true;
    }
    for (std::uint32_t face = 0; face < marked.size(); ++face)
        if (marked[face]) surface.nonManifold.push_back(face);
}

// Goes round one part, from `start`, and notes which of its faces are turned against the first.
std::vector<std::uint32_t> walkPart(const Edges& edges, std::uint32_t start, std::vector<bool>& seen,
                                    std::vector<bool>& turned) {
    std::vector<std::uint32_t> part{start};
    seen[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i)
        for (std::uint32_t side = 3 * part[i]; side < 3 * part[i] + 3; ++side) {
            const std::span<const std::uint32_t> sides = edges.sidesOf(edges.edgeOf(side));
            if (sides.size() != 2) continue;
            const std::uint32_t other = sides[0] == side ? sides[1] : sides[0];
            if (seen[other / 3] || edges.haveSameCorners(side / 3, other / 3)) continue;
            seen[other / 3] = true;
            turned[other / 3] = turned[part[i]] != (edges.isForward(side) == edges.isForward(other));
            part.push_back(other / 3);
        }
    return part;
}

std::vector<std::uint32_t> findTurned(const Edges& edges, std::size_t triangleCount) {
    std::vector<bool> turned(triangleCount, false), seen(triangleCount, false);
    for (std::uint32_t start = 0; start < triangleCount; ++start) {
        if (seen[start]) continue;
        const std::vector<std::uint32_t> part = walkPart(edges, start, seen, turned);
        const auto isTurned = [&](std::uint32_t face) { return turned[face]; };
        if (2 * std::count_if(part.begin(), part.end(), isTurned) > std::ssize(part))
            for (const std::uint32_t face : part) turned[face] = !turned[face];
    }
    std::vector<std::uint32_t> faces;
    for (std::uint32_t face = 0; face < triangleCount; ++face)
        if (turned[face]) faces.push_back(face);
    return faces;
}

void splitAlongEdges(const Edges& edges, std::span<const glm::uvec3> triangles,
                     std::span<const glm::vec3> faceNormals, SplitSurface& surface) {
    const std::vector<std::uint32_t> joined = joinSides(edges, faceNormals);
    splitVertices(triangles, joined, surface);
    countComponents(joined, surface.figures);
    countEdges(edges, joined, surface);
}

} // namespace

SplitSurface splitSurface(std::span<const glm::uvec3> triangles, std::span<const glm::vec3> faceNormals) {
    SplitSurface surface;
    const Edges edges(triangles);
    surface.turned = findTurned(edges, triangles.size());
    if (surface.turned.empty()) {
        splitAlongEdges(edges, triangles, faceNormals, surface);
    } else {
        std::vector<glm::uvec3> turnedTriangles(triangles.begin(), triangles.end());
        std::vector<glm::vec3> turnedNormals(faceNormals.begin(), faceNormals.end());
        for (const std::uint32_t face : surface.turned) {
            std::swap(turnedTriangles[face].y, turnedTriangles[face].z);
            turnedNormals[face] = -turnedNormals[face];
        }
        splitAlongEdges(Edges(turnedTriangles), turnedTriangles, turnedNormals, surface);
    }
    std::vector<bool> seen; // vertices that have a number already
    for (const std::uint32_t vertex : surface.vertexOf) {
        if (vertex >= seen.size()) seen.resize(vertex + 1, false);
        surface.figures.splitVertices += seen[vertex];
        seen[vertex] = true;
    }
    return surface;
}

} // namespace rt
