#pragma once
#include "common/binary_io.h"
#include "common/bounds.h"
#include "formats/atlas.shared.h"
#include "formats/material.shared.h"
#include "formats/mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rt {

/// What host programs want to know of an atlas and shaders do not.
struct AtlasInfo {
    double worldLo[3]; ///< bounds of the scene's triangles, world units
    double worldHi[3];
    double padCells;              ///< triangles are listed in every voxel they come this near to, in voxels
    std::uint64_t meshHash;       ///< content hash of the .rtmesh it was built from
    std::uint64_t occupiedVoxels; ///< with a list of triangles; bricks' voxels included
    std::uint64_t references;     ///< list entries in all voxels together
    std::uint32_t maxDistance;    ///< largest proximity value, voxels; 0 but for cloud
    std::uint32_t pageWidth;      ///< of a texture page, texels; 0 if there are no images
    std::uint32_t pageHeight;
    std::uint32_t pageCount;
};
static_assert(sizeof(AtlasInfo) == 96);

/// A scene ready for the GPU: each member is uploaded as it is.
struct Atlas {
    AtlasInfo info{};
    GridParams grid{};
    SharedSpan<std::uint32_t> voxels;        ///< dims.x*dims.y*dims.z words, x fastest; see atlas.shared.h
    SharedSpan<std::uint32_t> bricks;        ///< nested only: words of finer voxels; see atlas.shared.h
    SharedSpan<std::uint32_t> references;    ///< lists, one after the other; see atlas.shared.h
    SharedSpan<TriangleRecord> triangles;    ///< in the imported file's order
    SharedSpan<glm::uvec4> triangleVertices; ///< per triangle: three vertex indices, material
    SharedSpan<std::uint32_t> normals;       ///< per vertex, octEncode()d
    SharedSpan<glm::vec2> texcoords;         ///< per vertex; empty if no material has an image
    SharedSpan<Material> materials;
    SharedSpan<Light> lights;
    SharedSpan<NamedCamera> cameras;
    SharedSpan<ImagePlace> images;
    SharedSpan<std::uint32_t>
        pages; ///< pageCount * pageHeight * pageWidth RGBA8 texels, R in the lowest byte
    SharedSpan<CameraKey> cameraKeys;
    SharedSpan<Surroundings> surroundings; ///< one or none
    SharedSpan<glm::vec3> environment;

    std::uint64_t voxelCount() const { return std::uint64_t(grid.dims.x) * grid.dims.y * grid.dims.z; }
};

/// Replaces `triangles` by those of the list at `offset`, ascending.
inline void copyTriangles(std::span<const std::uint32_t> references, std::size_t offset,
                          std::vector<std::uint32_t>& triangles) {
    const std::size_t first = offset + kListHeaderWords;
    std::size_t last = first;
    while (!(references[last] & kLastInList)) ++last;
    triangles.assign(&references[first], &references[last] + 1);
    triangles.back() &= ~kLastInList;
}

/// A brick of a nested atlas and where it lies.
struct BrickPlace {
    std::uint32_t offset; ///< of its first word in Atlas::bricks
    int shift;            ///< (2^shift)^3 voxels
    int level;            ///< a voxel's side is 2^-level of that of a voxel of Atlas::voxels
    int depth;            ///< 1 in a voxel of Atlas::voxels, 2 in a brick of depth 1, ...
    glm::ivec3 first;     ///< its first voxel, counted in voxels of this size from the grid's corner

    std::uint32_t words() const { return 1u << (3 * shift); }
};

/// All bricks, in the file's order: for each voxel of Atlas::voxels that holds a brick, that brick, then the
/// bricks in it level by level, each level in the order of the words that lead there. Throws
/// Error{InvalidContent}, message prefixed by `name`, unless the bricks of Atlas::bricks stand in this order
/// without gaps and no level is finer than kMaxFinestSide allows: so each is reached once.
std::vector<BrickPlace> bricksOf(const Atlas& atlas, const std::string& name);

/// Throws as bricksOf() does, and keeps no more than the bricks of one voxel of Atlas::voxels at a time.
void requireBricksInOrder(const Atlas& atlas, const std::string& name);

/// "uniform", "cloud", ... as the command line names the structure kinds.
std::string structureName(std::uint32_t structure);

/// Throws Error{InvalidContent}, message prefixed by `name`, unless the grid is possible and the arrays are
/// as long as the grid, the counts and each other demand. Takes no time; indices in the arrays are not looked
/// at.
void validateSizes(const Atlas& atlas, const std::string& name);

/// As validateSizes(), and throws unless every count, index and number is in range.
void validate(const Atlas& atlas, const std::string& name);

} // namespace rt
