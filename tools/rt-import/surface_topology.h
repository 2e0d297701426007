#pragma once
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt {

/// What a surface is like, whatever its shape.
struct SurfaceFigures {
    std::uint64_t components = 0;       ///< parts that are connected across edges
    std::uint64_t closedComponents = 0; ///< of these, those without a border
    std::uint64_t boundaryEdges = 0;    ///< edges of one face
    std::uint64_t nonManifoldEdges =
        0;                           ///< edges of more than two faces, or of two that no turning makes agree
    std::uint64_t splitVertices = 0; ///< that were added so that the fans at a vertex do not touch
};

/// A surface of which each edge has at most two faces, turned alike, and each vertex one fan of faces.
struct SplitSurface {
    std::vector<glm::uvec3> triangles;      ///< as given, but turned, of the new vertices
    std::vector<std::uint32_t> vertexOf;    ///< of each new vertex: the given one
    std::vector<std::uint32_t> turned;      ///< triangles of which corners 1 and 2 were exchanged, in order
    std::vector<std::uint32_t> nonManifold; ///< triangles at edges of more than two faces, in order
    SurfaceFigures figures;
};

/// Turns faces round so that, within each part connected by edges of two faces, all are turned as most of
/// them are; where no turning does that (a Moebius strip), some edge counts as non-manifold. Then splits
/// vertices so that only joined faces meet, and keeps every face: at an edge of more than two, those that
/// continue each other best are joined in pairs. Triangles have three different vertices each and a unit
/// normal (or 0, of no area).
SplitSurface splitSurface(std::span<const glm::uvec3> triangles, std::span<const glm::vec3> faceNormals);

} // namespace rt
