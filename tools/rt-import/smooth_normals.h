#pragma once
#include "tools/rt-import/surface_topology.h"

#include <string>

namespace rt {

/// Unit normals of the triangles, (0, 0, 0) where the area is exactly 0.
std::vector<glm::vec3> findFaceNormals(std::span<const glm::vec3> positions,
                                       std::span<const glm::uvec3> triangles);

/// Smooths over a surface, of which positions are given for each vertex before it was split: returns three
/// unit normals per triangle. A corner's normal is the mean of the normals of the faces round its vertex that
/// are reached without crossing an edge sharper than `creaseDegrees` or a border, weighted by their angles
/// there (Thuermer and Wuethrich 1998). Corners of one such fan have the very same normal. A face at an edge
/// of more than two that is alone at its vertex takes the closest normal of the other faces there that no
/// crease separates from it, or else its own; a face of no area takes a neighbour's or else +z.
std::vector<glm::vec3> smoothNormals(std::span<const glm::vec3> positions, SplitSurface surface,
                                     double creaseDegrees);

/// "OpenMesh 9.0".
std::string openMeshVersion();

} // namespace rt
