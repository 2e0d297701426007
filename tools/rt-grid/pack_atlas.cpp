#include "tools/rt-grid/pack_atlas.h"

#include "formats/octahedral.shared.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

namespace rt {
namespace {

SharedSpan<glm::uvec4> verticesOfTriangles(const Mesh& mesh) {
    const FreshArray<glm::uvec4> vertices(mesh.triangles.size());
    tbb::parallel_for(std::size_t(0), vertices.size(), [&](std::size_t i) {
        vertices[i] = glm::uvec4(mesh.triangles[i], mesh.triangleMaterial[i]);
    });
    return vertices.share();
}

SharedSpan<std::uint32_t> encodedNormals(const Mesh& mesh) {
    const FreshArray<std::uint32_t> encoded(mesh.normals.size());
    tbb::parallel_for(std::size_t(0), encoded.size(),
                      [&](std::size_t i) { encoded[i] = octEncode(mesh.normals[i]); });
    return encoded.share();
}

SharedSpan<Material> materialsWithoutImages(const Mesh& mesh) {
    std::vector<Material> materials(mesh.materials.begin(), mesh.materials.end());
    for (Material& material : materials) {
        material.images = glm::uvec4(kNoImage);
        material.more.x = kNoImage;
    }
    return materials;
}

std::uint32_t largestDistance(const std::vector<std::uint32_t>& voxels) {
    using Range = tbb::blocked_range<std::size_t>;
    const auto ofRange = [&](const Range& range, std::uint32_t largest) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (!(voxels[i] & kOccupiedBit)) largest = std::max(largest, voxels[i]);
        return largest;
    };
    return tbb::parallel_reduce(Range(0, voxels.size()), 0u, ofRange,
                                [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

AtlasInfo makeInfo(const MeshFile& meshFile, std::uint32_t structure, const GridStages& stages) {
    AtlasInfo info{};
    for (int axis = 0; axis < 3; ++axis) {
        info.worldLo[axis] = stages.worldBounds.lo[axis];
        info.worldHi[axis] = stages.worldBounds.hi[axis];
    }
    info.padCells = stages.layout.padCells;
    info.meshHash = meshFile.contentHash;
    info.occupiedVoxels = stages.words.occupiedVoxels;
    info.references = stages.words.referenceCount;
    info.maxDistance = structure == kStructureCloud ? largestDistance(stages.words.voxels) : 0u;
    info.pageWidth = stages.pages.width;
    info.pageHeight = stages.pages.height;
    info.pageCount = stages.pages.pageCount;
    return info;
}

GridParams makeGrid(const Mesh& mesh, std::uint32_t structure, const GridStages& stages) {
    const GridLayout& layout = stages.layout;
    GridParams grid{};
    grid.gridLo = glm::vec4(layout.gridLo, 0.0f);
    grid.cellSize = glm::vec4(layout.cellSize, 0.0f);
    grid.cellsPerUnit = glm::vec4(layout.cellsPerUnit, 0.0f);
    grid.worldOffset = glm::vec4(stages.rebase.offsetWorld, stages.rebase.scale);
    grid.dims = glm::uvec4(layout.dims, structure);
    grid.counts =
        glm::uvec4(mesh.triangles.size(), mesh.positions.size(), mesh.materials.size(), mesh.lights.size());
    return grid;
}

} // namespace

bool showsImages(const Mesh& mesh) {
    return !mesh.texcoords.empty() &&
           std::any_of(mesh.materials.begin(), mesh.materials.end(), [](const Material& m) {
               return m.images != glm::uvec4(kNoImage) || m.more.x != kNoImage;
           });
}

Atlas packAtlas(const MeshFile& meshFile, std::uint32_t structure, GridStages stages) {
    const Mesh& mesh = meshFile.mesh;
    const bool textured = showsImages(mesh);
    Atlas atlas;
    atlas.info = makeInfo(meshFile, structure, stages);
    atlas.grid = makeGrid(mesh, structure, stages);
    atlas.voxels = std::move(stages.words.voxels);
    atlas.bricks = std::move(stages.words.bricks);
    atlas.references = std::move(stages.words.references);
    atlas.triangles = stages.triangles.share();
    atlas.triangleVertices = verticesOfTriangles(mesh);
    atlas.normals = encodedNormals(mesh);
    if (textured) atlas.texcoords = mesh.texcoords;
    atlas.materials = textured ? mesh.materials : materialsWithoutImages(mesh);
    atlas.lights = mesh.lights;
    atlas.cameras = mesh.cameras;
    atlas.cameraKeys = mesh.cameraKeys;
    atlas.surroundings = mesh.surroundings;
    atlas.environment = mesh.environment;
    atlas.pages = paintPages(mesh, stages.pages);
    atlas.images = std::move(stages.pages.places);
    return atlas;
}

} // namespace rt
