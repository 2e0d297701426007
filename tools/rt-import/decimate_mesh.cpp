#include "tools/rt-import/decimate_mesh.h"

#include "common/bounds.h"
#include "tools/rt-import/halfedge_mesh.h"
#include "tools/rt-import/read_scene.h"
#include "tools/rt-import/weld_vertices.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// Not above: it needs what the mesh includes.
#include <OpenMesh/Core/Geometry/QuadricT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/Observer.hh>

#include <algorithm>

namespace rt {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using Decimater = OpenMesh::Decimater::DecimaterT<HalfedgeMesh>;
using NormalFlipping = OpenMesh::Decimater::ModNormalFlippingT<HalfedgeMesh>;
using OpenMesh::Geometry::Quadricd;

// OpenMesh's own module of quadrics knows no borders, which would wear away, and no texture coordinates.
class SurfaceQuadrics : public OpenMesh::Decimater::ModBaseT<HalfedgeMesh> {
public:
    using Base = OpenMesh::Decimater::ModBaseT<HalfedgeMesh>;
    using Handle = OpenMesh::Decimater::ModHandleT<SurfaceQuadrics>;
    using CollapseInfo = Base::CollapseInfo;
    DECIMATER_MODNAME(SurfaceQuadrics)

    explicit SurfaceQuadrics(HalfedgeMesh& halfedges) : Base(halfedges, false) {}

    void setSurface(std::vector<glm::uvec3>& vertices, std::vector<glm::uvec3>& corners) {
        vertices_ = &vertices;
        corners_ = &corners;
    }

    void initialize() override;
    float collapse_priority(const CollapseInfo& collapse) override;
    void preprocess_collapse(const CollapseInfo& collapse) override;
    void postprocess_collapse(const CollapseInfo& collapse) override {
        quadricOf(collapse.v1) += quadricOf(collapse.v0);
    }

private:
    Quadricd& quadricOf(OpenMesh::VertexHandle v) { return quadrics_[static_cast<std::size_t>(v.idx())]; }
    void addPlane(const OpenMesh::Vec3d& unitNormal, const OpenMesh::Vec3d& point, double weight,
                  std::initializer_list<OpenMesh::VertexHandle> vertices);
    void addBorders();

    std::vector<Quadricd> quadrics_;
    std::vector<glm::uvec3>* vertices_ = nullptr; // of each face: vertices of the halfedge mesh
    std::vector<glm::uvec3>* corners_ = nullptr;  // and those of the soup that stand there
};

void SurfaceQuadrics::addPlane(const OpenMesh::Vec3d& unitNormal, const OpenMesh::Vec3d& point, double weight,
                               std::initializer_list<OpenMesh::VertexHandle> vertices) {
    Quadricd quadric(unitNormal[0], unitNormal[1], unitNormal[2], -(unitNormal | point));
    quadric *= weight;
    for (const OpenMesh::VertexHandle v : vertices) quadricOf(v) += quadric;
}

void SurfaceQuadrics::addBorders() {
    constexpr double kBorderWeight = 10.0;
    for (const auto h : mesh().halfedges()) {
        if (!h.is_boundary()) continue;
        const OpenMesh::Vec3d start = mesh().point(h.from()), along = mesh().point(h.to()) - start;
        const OpenMesh::Vec3d across = along % mesh().normal(h.opp().face());
        const double length = across.norm();
        if (length > 0.0)
            addPlane(across / length, start, kBorderWeight * along.sqrnorm(), {h.from(), h.to()});
    }
}

void SurfaceQuadrics::initialize() {
    quadrics_.assign(mesh().n_vertices(), Quadricd(0.0, 0.0, 0.0, 0.0));
    for (const OpenMesh::FaceHandle face : mesh().faces()) {
        auto vertex = mesh().fv_iter(face);
        const OpenMesh::VertexHandle a = *vertex++, b = *vertex++, c = *vertex;
        const OpenMesh::Vec3d at = mesh().point(a);
        const OpenMesh::Vec3d normal = (mesh().point(b) - at) % (mesh().point(c) - at);
        const double length = normal.norm();
        if (length > 0.0) addPlane(normal / length, at, 0.5 * length, {a, b, c});
    }
    addBorders();
}

// Where nothing would move, the shortest edges go first, which keeps triangles from becoming slivers.
float SurfaceQuadrics::collapse_priority(const CollapseInfo& collapse) {
    constexpr double kShape = 1e-6;
    Quadricd quadric = quadricOf(collapse.v0);
    quadric += quadricOf(collapse.v1);
    const double length2 = (collapse.p1 - collapse.p0).sqrnorm();
    return static_cast<float>(std::max(quadric(collapse.p1), 0.0) + kShape * length2 * length2);
}

// The faces that stay get, at their corner that moves, what a face that goes has at its target: the two are
// on one side of any seam there.
void SurfaceQuadrics::preprocess_collapse(const CollapseInfo& collapse) {
    const auto indexOf = [](auto handle) { return static_cast<std::size_t>(handle.idx()); };
    const auto from = static_cast<std::uint32_t>(collapse.v0.idx()),
               to = static_cast<std::uint32_t>(collapse.v1.idx());
    const auto cornerAt = [&](std::size_t face, std::uint32_t vertex) {
        const glm::uvec3& t = (*vertices_)[face];
        return t.x == vertex ? 0 : t.y == vertex ? 1 : 2;
    };
    const std::size_t gone = indexOf(collapse.fl.is_valid() ? collapse.fl : collapse.fr);
    const std::uint32_t soupVertex = (*corners_)[gone][cornerAt(gone, to)];
    for (const OpenMesh::FaceHandle face : mesh().vf_range(collapse.v0)) {
        if (face == collapse.fl || face == collapse.fr) continue;
        const int k = cornerAt(indexOf(face), from);
        (*vertices_)[indexOf(face)][k] = to;
        (*corners_)[indexOf(face)][k] = soupVertex;
    }
}

class DecimationProgress : public OpenMesh::Decimater::Observer {
public:
    DecimationProgress(std::size_t collapses, const std::function<void(double)>& progress)
        : Observer(kInterval), collapses_(static_cast<double>(collapses)), progress_(progress) {}
    void notify(std::size_t step) override { progress_(static_cast<double>(step) / collapses_); }

private:
    static constexpr std::size_t kInterval = 1000;
    double collapses_;
    const std::function<void(double)>& progress_;
};

// Points are moved to a box of side 1 round the origin, so that no error under- or overflows.
void setPoints(HalfedgeMesh& mesh, const Weld& weld, const SplitSurface& surface) {
    Bounds bounds;
    for (const glm::vec3& position : weld.positions) bounds.add(position);
    const glm::dvec3 centre(bounds.centre()), extent(bounds.extent());
    const double side = std::max({extent.x, extent.y, extent.z, 1e-300});
    for (const OpenMesh::VertexHandle v : mesh.vertices()) {
        const std::uint32_t welded = surface.vertexOf[static_cast<std::size_t>(v.idx())];
        const glm::dvec3 p = (glm::dvec3(weld.positions[welded]) - centre) / side;
        mesh.set_point(v, {p.x, p.y, p.z});
    }
}

// Locks the vertices that must not go.
void lockSeams(HalfedgeMesh& mesh, const SceneSoup& soup, const SplitSurface& surface) {
    constexpr std::size_t kNone = ~std::size_t(0);
    const auto lock = [&](std::uint32_t vertex) {
        mesh.status(OpenMesh::VertexHandle(static_cast<int>(vertex))).set_locked(true);
    };
    std::vector<std::size_t> firstCorner(surface.vertexOf.size(), kNone);
    for (std::size_t corner = 0; corner < surface.triangles.size() * 3; ++corner) {
        const auto k = static_cast<int>(corner % 3);
        const std::uint32_t vertex = surface.triangles[corner / 3][k];
        std::size_t& first = firstCorner[vertex];
        if (first == kNone) first = corner;
        const std::uint32_t here = soup.triangles[corner / 3][k],
                            there = soup.triangles[first / 3][static_cast<int>(first % 3)];
        const bool sameMaterial = soup.triangleMaterial[corner / 3] == soup.triangleMaterial[first / 3];
        const bool sameTexcoord = soup.texcoords.empty() || soup.texcoords[here] == soup.texcoords[there];
        if (!sameMaterial || !sameTexcoord) lock(vertex);
    }
    std::vector<std::uint32_t> firstOf; // of each vertex before the split: the first that it became
    constexpr std::uint32_t kNoVertex = 0xFFFFFFFFu;
    for (std::uint32_t vertex = 0; vertex < surface.vertexOf.size(); ++vertex) {
        const std::uint32_t welded = surface.vertexOf[vertex];
        if (welded >= firstOf.size()) firstOf.resize(welded + 1, kNoVertex);
        if (firstOf[welded] == kNoVertex) {
            firstOf[welded] = vertex;
        } else {
            lock(vertex);
            lock(firstOf[welded]);
        }
    }
}

} // namespace

void decimate(SceneSoup& soup, const Weld& weld, SplitSurface surface, std::size_t target,
              const std::function<void(double)>& progress) {
    omerr().disable(); // it announces each face that it refuses
    HalfedgeMesh mesh;
    addFaces(mesh, surface);
    setPoints(mesh, weld, surface);
    mesh.request_vertex_status();
    mesh.request_edge_status();
    mesh.request_halfedge_status();
    mesh.request_face_status();
    mesh.request_face_normals();
    mesh.update_face_normals();
    lockSeams(mesh, soup, surface);

    Decimater decimater(mesh);
    SurfaceQuadrics::Handle quadrics;
    NormalFlipping::Handle flipping;
    decimater.add(quadrics);
    decimater.add(flipping);
    decimater.module(quadrics).setSurface(surface.triangles, soup.triangles);
    decimater.initialize();
    DecimationProgress observer((soup.triangles.size() - target) / 2 + 1,
                                progress); // each takes two triangles
    decimater.set_observer(&observer);
    decimater.decimate_to_faces(0, target);
    std::vector<bool> dropped(soup.triangles.size());
    for (std::size_t face = 0; face < dropped.size(); ++face)
        dropped[face] = mesh.status(OpenMesh::FaceHandle(static_cast<int>(face))).deleted();
    removeTriangles(soup, dropped);
    soup.normals.clear();
}

} // namespace rt
