#pragma once
#include "formats/mesh.h"
#include "tools/rt-import/read_scene.h"

#include <span>
#include <vector>

namespace rt {

/// Which vertices of a soup stand at the same position.
struct Weld {
    std::vector<glm::vec3> positions;  ///< the distinct ones, in the order of first use by a triangle; no -0
    std::vector<glm::uvec3> triangles; ///< as the soup's, indexing these positions
    std::uint64_t movedPositions = 0;  ///< that became one with another within the distance
};

/// Positions are the same if all their bits are, but that -0 is +0, or if `distance` or less separates one
/// from the first that was there.
Weld weldPositions(const SceneSoup& soup, double distance = 0.0);

/// Makes an indexed mesh of the corners of the triangles: those that agree in position, normal and texture
/// coordinates share a vertex; vertices stand in the order of first use. `cornerNormals`, three per triangle,
/// stand in where the soup has no normal. Fills positions, normals, texcoords and triangles of the result.
Mesh mergeCorners(const SceneSoup& soup, const Weld& weld, std::span<const glm::vec3> cornerNormals);

/// Corners for which the soup has no normal.
std::uint64_t countMissingNormals(const SceneSoup& soup);

} // namespace rt
