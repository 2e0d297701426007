#pragma once
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rt {

struct RepairedSurface {
    std::vector<glm::vec3> cornerNormals;  ///< three per triangle, unit; empty if not wanted
    std::uint64_t degenerateTriangles = 0; ///< area exactly zero
    std::uint64_t nonManifoldFaces = 0;    ///< refused by the halfedge mesh: a third face at an edge, a
                                           ///< duplicate, or turned against its neighbours
};

/// Builds a halfedge mesh (OpenMesh) of welded positions and smooths over it: a corner's normal is the mean
/// of the normals of the faces round its vertex that are reached without crossing an edge sharper than
/// `creaseDegrees`, a border or a refused face, weighted by their angles there (Thuermer and Wuethrich 1998).
/// Corners of one such fan have the very same normal. A refused face takes at each corner the closest normal
/// of the fans there that no crease separates from it, or else its own; a face of no area takes a neighbour's
/// or else +z.
RepairedSurface repairSurface(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                              double creaseDegrees, bool wantNormals);

/// "OpenMesh 9.0".
std::string openMeshVersion();

} // namespace rt
