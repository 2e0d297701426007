#include "tools/rt-import/smooth_normals.h"

#include "tools/rt-import/halfedge_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>

namespace rt {
namespace {

using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;
using Halfedge = OpenMesh::HalfedgeHandle;

glm::dvec3 unitOrZero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

glm::dvec3 faceNormal(std::span<const glm::vec3> positions, const glm::uvec3& t) {
    const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
    return unitOrZero(glm::cross(b - a, c - a));
}

class Surface {
public:
    Surface(std::span<const glm::vec3> positions, SplitSurface split, double creaseDegrees)
        : positions_(positions), split_(std::move(split)), minCosine_(std::cos(glm::radians(creaseDegrees))) {
    }

    void build();
    void smooth();

    std::vector<glm::vec3> cornerNormals;

private:
    std::size_t triangleOf(Halfedge h) const {
        return static_cast<std::size_t>(mesh_.face_handle(h).idx()); // faces are numbered as triangles are
    }
    auto halfedgesOf(std::size_t triangle) const {
        return mesh_.fh_range(OpenMesh::FaceHandle(static_cast<int>(triangle)));
    }
    std::uint32_t vertexAt(std::size_t corner) const {
        return split_.triangles[corner / 3][static_cast<int>(corner % 3)];
    }
    glm::dvec3 positionAt(std::size_t triangle, std::size_t k) const {
        return glm::dvec3(positions_[split_.vertexOf[vertexAt(triangle * 3 + k % 3)]]);
    }
    std::size_t cornerOf(Halfedge h) const; // the corner that the halfedge points to
    double angleAt(std::size_t corner) const;
    bool isSmooth(Halfedge edge) const;
    void borrowNormals();
    std::vector<std::size_t> fanOf(Halfedge h) const;
    void smoothFan(const std::vector<std::size_t>& fan);
    std::vector<std::size_t> listLoners() const;
    void joinLoners();

    std::span<const glm::vec3> positions_;
    SplitSurface split_;
    double minCosine_;
    HalfedgeMesh mesh_;
    std::vector<glm::dvec3> faceNormals_; // per triangle; 0 where the area is
};

void Surface::build() {
    omerr().disable(); // it announces each face that it refuses
    addFaces(mesh_, split_);
    faceNormals_.reserve(split_.triangles.size());
    for (const glm::uvec3& t : split_.triangles)
        faceNormals_.push_back(
            faceNormal(positions_, {split_.vertexOf[t.x], split_.vertexOf[t.y], split_.vertexOf[t.z]}));
}

std::size_t Surface::cornerOf(Halfedge h) const {
    const std::size_t triangle = triangleOf(h);
    const auto vertex = static_cast<std::uint32_t>(mesh_.to_vertex_handle(h).idx());
    const glm::uvec3& t = split_.triangles[triangle];
    return triangle * 3 + (t.x == vertex ? 0u : t.y == vertex ? 1u : 2u);
}

double Surface::angleAt(std::size_t corner) const {
    const std::size_t triangle = corner / 3, k = corner % 3;
    const glm::dvec3 at = positionAt(triangle, k);
    const glm::dvec3 u = positionAt(triangle, k + 1) - at, v = positionAt(triangle, k + 2) - at;
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

bool Surface::isSmooth(Halfedge edge) const {
    if (mesh_.is_boundary(mesh_.edge_handle(edge))) return false;
    const std::size_t here = triangleOf(edge), there = triangleOf(mesh_.opposite_halfedge_handle(edge));
    return glm::dot(faceNormals_[here], faceNormals_[there]) >= minCosine_;
}

// A face without area must not cut the surface round it into two.
void Surface::borrowNormals() {
    for (std::size_t triangle = 0; triangle < faceNormals_.size(); ++triangle) {
        glm::dvec3& normal = faceNormals_[triangle];
        if (normal != glm::dvec3(0.0)) continue;
        for (Halfedge h : halfedgesOf(triangle)) {
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
        cornerNormals[corner] = normal == glm::dvec3(0.0) ? faceNormals_[corner / 3] : normal;
}

// Corners of faces that were left over at an edge and share their vertex with no other.
std::vector<std::size_t> Surface::listLoners() const {
    std::vector<std::uint8_t> cornerCount(split_.vertexOf.size(), 0); // up to 2
    for (std::size_t corner = 0; corner < split_.triangles.size() * 3; ++corner) {
        std::uint8_t& count = cornerCount[vertexAt(corner)];
        if (count < 2) ++count;
    }
    std::vector<std::size_t> loners;
    for (const std::size_t triangle : split_.nonManifold)
        for (std::size_t corner = triangle * 3; corner < triangle * 3 + 3; ++corner)
            if (cornerCount[vertexAt(corner)] == 1) loners.push_back(corner);
    return loners;
}

// Shades what lies on a smooth surface without being joined to it, a second copy of a face, say, as that is.
void Surface::joinLoners() {
    const std::vector<std::size_t> loners = listLoners();
    if (loners.empty()) return;
    std::vector<bool> wanted(positions_.size(), false), isLoner(cornerNormals.size(), false);
    for (const std::size_t corner : loners) {
        wanted[split_.vertexOf[vertexAt(corner)]] = true;
        isLoner[corner] = true;
    }
    std::vector<std::pair<std::uint32_t, std::size_t>> others; // unsplit vertex and corner there
    for (std::size_t corner = 0; corner < cornerNormals.size(); ++corner) {
        const std::uint32_t vertex = split_.vertexOf[vertexAt(corner)];
        if (wanted[vertex] && !isLoner[corner]) others.emplace_back(vertex, corner);
    }
    std::sort(others.begin(), others.end());
    for (const std::size_t corner : loners) {
        const std::uint32_t vertex = split_.vertexOf[vertexAt(corner)];
        const glm::dvec3 own = faceNormals_[corner / 3];
        double best = minCosine_;
        auto other = std::lower_bound(others.begin(), others.end(), std::pair(vertex, std::size_t(0)));
        for (; other != others.end() && other->first == vertex; ++other) {
            const double cosine = glm::dot(own, glm::dvec3(cornerNormals[other->second]));
            if (cosine < best) continue;
            best = cosine;
            cornerNormals[corner] = cornerNormals[other->second];
        }
    }
}

void Surface::smooth() {
    borrowNormals();
    cornerNormals.assign(split_.triangles.size() * 3, glm::vec3(0.0f));
    for (std::size_t triangle = 0; triangle < split_.triangles.size(); ++triangle)
        for (Halfedge h : halfedgesOf(triangle))
            if (cornerNormals[cornerOf(h)] == glm::vec3(0.0f)) smoothFan(fanOf(h));
    joinLoners();
}

} // namespace

std::vector<glm::vec3> findFaceNormals(std::span<const glm::vec3> positions,
                                       std::span<const glm::uvec3> triangles) {
    std::vector<glm::vec3> normals;
    normals.reserve(triangles.size());
    for (const glm::uvec3& t : triangles) normals.emplace_back(faceNormal(positions, t));
    return normals;
}

std::vector<glm::vec3> smoothNormals(std::span<const glm::vec3> positions, SplitSurface split,
                                     double creaseDegrees) {
    Surface surface(positions, std::move(split), creaseDegrees);
    surface.build();
    surface.smooth();
    return std::move(surface.cornerNormals);
}

std::string openMeshVersion() {
    return fmt::format("OpenMesh {}.{}", OM_GET_VER, OM_GET_MAJ);
}

} // namespace rt
