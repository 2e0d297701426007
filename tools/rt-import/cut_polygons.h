#pragma once
#include <cstdint>
#include <vector>

struct aiScene;

namespace rt {

/// The polygons of a mesh before they are cut into triangles, and which triangle is whose afterwards.
struct CutPolygons {
    std::vector<std::uint32_t> firstCorner; ///< of each polygon and behind the last; empty: only triangles
    std::vector<std::uint32_t> corners;     ///< indices of vertices

    std::vector<std::uint32_t> ofTriangle; ///< polygon of each face once cut; empty: each is its own
    std::vector<std::uint32_t> bad;        ///< polygons that gave fewer triangles than their corners ask for
};

/// Notes the polygons of all meshes. Polygons with vertices that do not exist lose all their corners, for the
/// cutting would read them.
std::vector<CutPolygons> listPolygons(aiScene& scene);

/// Finds out, once the polygons are cut in place and in order, which triangle was cut from which.
void matchTriangles(const aiScene& scene, std::vector<CutPolygons>& polygons);

} // namespace rt
