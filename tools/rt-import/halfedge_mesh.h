#pragma once
#include "tools/rt-import/surface_topology.h"

namespace rt {

// A template, so that this header needs none of OpenMesh's.

/// Adds the surface's vertices and triangles to an empty halfedge mesh of OpenMesh, each under its own
/// number. A face that the mesh refuses all the same gets vertices of its own, in `surface` too.
template <class HalfedgeMesh>
void addFaces(HalfedgeMesh& mesh, SplitSurface& surface) {
    const auto handle = [](std::uint32_t v) {
        return typename HalfedgeMesh::VertexHandle(static_cast<int>(v));
    };
    const std::size_t faces = surface.triangles.size();
    mesh.reserve(surface.vertexOf.size(), faces * 3 / 2, faces);
    for (std::size_t v = 0; v < surface.vertexOf.size(); ++v) mesh.new_vertex();
    for (glm::uvec3& t : surface.triangles) {
        if (mesh.add_face(handle(t.x), handle(t.y), handle(t.z)).is_valid()) continue;
        for (int k = 0; k < 3; ++k) {
            surface.vertexOf.push_back(surface.vertexOf[t[k]]);
            t[k] = static_cast<std::uint32_t>(mesh.new_vertex().idx());
        }
        mesh.add_face(handle(t.x), handle(t.y), handle(t.z));
    }
}

} // namespace rt
