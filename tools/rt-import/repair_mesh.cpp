#include "tools/rt-import/repair_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <cmath>

namespace rt {
namespace {

using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;
using Halfedge = OpenMesh::HalfedgeHandle;

class Surface {
public:
    Surface(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, double creaseDegrees)
        : positions_(positions), triangles_(triangles), minCosine_(std::cos(glm::radians(creaseDegrees))) {}

    void build();
    void smooth();

    RepairedSurface result;

private:
    std::uint32_t triangleOf(Halfedge h) const {
        return triangleOfFace_[static_cast<std::size_t>(mesh_.face_handle(h).idx())];
    }
    std::size_t cornerOf(Halfedge h) const; // the corner that the halfedge points to
    double angleAt(std::size_t corner) const;
    bool isSmooth(Halfedge edge) const;
    void borrowNormals();
    std::vector<std::size_t> fanOf(Halfedge h) const;
    void smoothFan(const std::vector<std::size_t>& fan);
    glm::vec3 nearestFanNormal(std::size_t corner) const;

    std::span<const glm::vec3> positions_;
    std::span<const glm::uvec3> triangles_;
    double minCosine_;
    HalfedgeMesh mesh_;
    std::vector<std::uint32_t> triangleOfFace_; // OpenMesh numbers only the faces that it took
    std::vector<glm::dvec3> faceNormals_;       // per triangle; 0 where the area is
};

glm::dvec3 unitOrZero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

void Surface::build() {
    omerr().disable(); // refused faces are counted, not announced one by one
    mesh_.reserve(positions_.size(), triangles_.size() * 3 / 2, triangles_.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) mesh_.new_vertex();
    triangleOfFace_.reserve(triangles_.size());
    faceNormals_.reserve(triangles_.size());
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
        const glm::uvec3& t = triangles_[i];
        const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
        faceNormals_.push_back(unitOrZero(glm::cross(b - a, c - a)));
        result.degenerateTriangles += faceNormals_.back() == glm::dvec3(0.0);
        if (t.x == t.y || t.y == t.z || t.z == t.x) continue; // has no halfedges
        const auto handle = [](std::uint32_t v) { return OpenMesh::VertexHandle(static_cast<int>(v)); };
        const auto face = mesh_.add_face(handle(t.x), handle(t.y), handle(t.z));
        if (face.is_valid())
            triangleOfFace_.push_back(i);
        else
            ++result.nonManifoldFaces;
    }
}

std::size_t Surface::cornerOf(Halfedge h) const {
    const std::uint32_t triangle = triangleOf(h);
    const auto vertex = static_cast<std::uint32_t>(mesh_.to_vertex_handle(h).idx());
    const glm::uvec3& t = triangles_[triangle];
    return std::size_t(triangle) * 3 + (t.x == vertex ? 0u : t.y == vertex ? 1u : 2u);
}

double Surface::angleAt(std::size_t corner) const {
    const glm::uvec3& t = triangles_[corner / 3];
    const auto k = static_cast<int>(corner % 3);
    const glm::dvec3 at(positions_[t[k]]);
    const glm::dvec3 u = glm::dvec3(positions_[t[(k + 1) % 3]]) - at;
    const glm::dvec3 v = glm::dvec3(positions_[t[(k + 2) % 3]]) - at;
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

bool Surface::isSmooth(Halfedge edge) const {
    if (mesh_.is_boundary(mesh_.edge_handle(edge))) return false;
    const std::uint32_t here = triangleOf(edge), there = triangleOf(mesh_.opposite_halfedge_handle(edge));
    return glm::dot(faceNormals_[here], faceNormals_[there]) >= minCosine_;
}

// A face without area must not cut the surface round it into two.
void Surface::borrowNormals() {
    for (std::size_t f = 0; f < triangleOfFace_.size(); ++f) {
        glm::dvec3& normal = faceNormals_[triangleOfFace_[f]];
        for (Halfedge h : mesh_.fh_range(OpenMesh::FaceHandle(static_cast<int>(f)))) {
            if (normal != glm::dvec3(0.0)) break;
            const Halfedge opposite = mesh_.opposite_halfedge_handle(h);
            if (!mesh_.is_boundary(opposite)) normal = faceNormals_[triangleOf(opposite)];
        }
    }
    for (glm::dvec3& normal : faceNormals_)
        if (normal == glm::dvec3(0.0)) normal = glm::dvec3(0.0, 0.0, 1.0);
}

// Corners round the halfedge's vertex that no crease separates from its own.
std::vector<std::size_t> Surface::fanOf(Halfedge h) const {
    Halfedge first = h; // turn clockwise to the crease, if there is one
    while (isSmooth(mesh_.next_halfedge_handle(first))) {
        first = mesh_.opposite_halfedge_handle(mesh_.next_halfedge_handle(first));
        if (first == h) break;
    }
    std::vector<std::size_t> fan;
    Halfedge current = first;
    do {
        fan.push_back(cornerOf(current));
        if (!isSmooth(current)) break;
        current = mesh_.prev_halfedge_handle(mesh_.opposite_halfedge_handle(current));
    } while (current != first);
    return fan;
}

void Surface::smoothFan(const std::vector<std::size_t>& fan) {
    glm::dvec3 sum(0.0);
    for (std::size_t corner : fan) sum += faceNormals_[corner / 3] * angleAt(corner);
    const glm::dvec3 normal = unitOrZero(sum);
    for (std::size_t corner : fan)
        result.cornerNormals[corner] = normal == glm::dvec3(0.0) ? faceNormals_[corner / 3] : normal;
}

// Of the fans round the corner's vertex, the normal closest to that of the corner's face, if no crease lies
// between.
glm::vec3 Surface::nearestFanNormal(std::size_t corner) const {
    const glm::dvec3& own = faceNormals_[corner / 3];
    const OpenMesh::VertexHandle vertex(
        static_cast<int>(triangles_[corner / 3][static_cast<int>(corner % 3)]));
    glm::vec3 nearest(own);
    double best = minCosine_;
    for (Halfedge h : mesh_.vih_range(vertex)) {
        if (mesh_.is_boundary(h)) continue;
        const glm::vec3& normal = result.cornerNormals[cornerOf(h)];
        const double cosine = glm::dot(own, glm::dvec3(normal));
        if (cosine < best) continue;
        best = cosine;
        nearest = normal;
    }
    return nearest;
}

void Surface::smooth() {
    borrowNormals();
    result.cornerNormals.assign(triangles_.size() * 3, glm::vec3(0.0f));
    for (std::size_t f = 0; f < triangleOfFace_.size(); ++f)
        for (Halfedge h : mesh_.fh_range(OpenMesh::FaceHandle(static_cast<int>(f))))
            if (result.cornerNormals[cornerOf(h)] == glm::vec3(0.0f)) smoothFan(fanOf(h));
    // Only faces outside the halfedge mesh are left; they read what the fans inside it have got.
    for (std::size_t corner = 0; corner < result.cornerNormals.size(); ++corner)
        if (result.cornerNormals[corner] == glm::vec3(0.0f))
            result.cornerNormals[corner] = nearestFanNormal(corner);
}

} // namespace

RepairedSurface repairSurface(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                              double creaseDegrees, bool wantNormals) {
    Surface surface(positions, triangles, creaseDegrees);
    surface.build();
    if (wantNormals) surface.smooth();
    return std::move(surface.result);
}

std::string openMeshVersion() {
    return fmt::format("OpenMesh {}.{}", OM_GET_VER, OM_GET_MAJ);
}

} // namespace rt
