#include "tools/rt-import/cut_polygons.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <span>

namespace rt {
namespace {

std::span<const unsigned> cornersOf(const aiFace& face) {
    return {face.mIndices, face.mNumIndices};
}

void removeMissingVertices(aiMesh& mesh) {
    for (aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
        const std::span<const unsigned> corners = cornersOf(face);
        const bool missing = std::any_of(corners.begin(), corners.end(),
                                         [&](unsigned corner) { return corner >= mesh.mNumVertices; });
        if (corners.size() > 3 && missing) face.mNumIndices = 0;
    }
}

CutPolygons listOf(const aiMesh& mesh) {
    CutPolygons polygons;
    const std::span<const aiFace> faces(mesh.mFaces, mesh.mNumFaces);
    if (std::all_of(faces.begin(), faces.end(), [](const aiFace& face) { return face.mNumIndices <= 3; }))
        return polygons;
    polygons.firstCorner.reserve(faces.size() + 1);
    for (const aiFace& face : faces) {
        polygons.firstCorner.push_back(static_cast<std::uint32_t>(polygons.corners.size()));
        const std::span<const unsigned> corners = cornersOf(face);
        polygons.corners.insert(polygons.corners.end(), corners.begin(), corners.end());
    }
    polygons.firstCorner.push_back(static_cast<std::uint32_t>(polygons.corners.size()));
    return polygons;
}

// Walks polygons and triangles side by side: a triangle belongs to the polygon at hand if that has all its
// corners and has not yet given what it should.
void match(std::span<const aiFace> faces, CutPolygons& polygons) {
    const auto count = static_cast<std::uint32_t>(polygons.firstCorner.size() - 1);
    std::uint32_t current = 0, given = 0;
    const auto cornersAt = [&](std::uint32_t polygon) {
        const std::uint32_t first = polygons.firstCorner[polygon];
        return std::span(polygons.corners).subspan(first, polygons.firstCorner[polygon + 1] - first);
    };
    const auto wanted = [&] { return std::max<std::size_t>(cornersAt(current).size(), 3) - 2; };
    const auto next = [&] {
        if (given < wanted()) polygons.bad.push_back(current);
        ++current;
        given = 0;
    };
    polygons.ofTriangle.reserve(faces.size());
    for (const aiFace& face : faces) {
        const auto has = [&](unsigned corner) {
            const auto corners = cornersAt(current);
            return std::find(corners.begin(), corners.end(), corner) != corners.end();
        };
        const std::span<const unsigned> corners = cornersOf(face);
        while (current + 1 < count &&
               (given == wanted() || !std::all_of(corners.begin(), corners.end(), has)))
            next();
        polygons.ofTriangle.push_back(current);
        ++given;
    }
    while (current < count) next();
    polygons.firstCorner = {}; // they have served
    polygons.corners = {};
}

} // namespace

std::vector<CutPolygons> listPolygons(aiScene& scene) {
    std::vector<CutPolygons> polygons;
    for (aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes)) {
        removeMissingVertices(*mesh);
        polygons.push_back(listOf(*mesh));
    }
    return polygons;
}

void matchTriangles(const aiScene& scene, std::vector<CutPolygons>& polygons) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
        if (!polygons[m].firstCorner.empty())
            match({scene.mMeshes[m]->mFaces, scene.mMeshes[m]->mNumFaces}, polygons[m]);
}

} // namespace rt
