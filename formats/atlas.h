#pragma once
#include "common/binary_io.h"
#include "common/bounds.h"
#include "formats/atlas.shared.h"
#include "formats/material.shared.h"

#include <cstdint>
#include <string>

namespace rt {

/// What host programs want to know of an atlas and shaders do not.
struct AtlasInfo {
    double worldLo[3]; ///< bounds of the scene's triangles, world units
    double worldHi[3];
    double padCells;        ///< triangles are listed in every voxel they come this near to, in voxels
    std::uint64_t meshHash; ///< content hash of the .rtmesh it was built from
    std::uint64_t occupiedVoxels;
    std::uint64_t references;  ///< list entries in all voxels together
    std::uint32_t maxDistance; ///< largest proximity value, voxels; 0 for uniform
    std::uint32_t pageWidth;   ///< of a texture page, texels; 0 if there are no images
    std::uint32_t pageHeight;
    std::uint32_t pageCount;
};
static_assert(sizeof(AtlasInfo) == 96);

/// A scene ready for the GPU: each member is uploaded as it is.
struct Atlas {
    AtlasInfo info{};
    GridParams grid{};
    SharedSpan<std::uint32_t> voxels;        ///< dims.x*dims.y*dims.z words, x fastest; see atlas.shared.h
    SharedSpan<std::uint32_t> references;    ///< lists: count, then that many triangle indices, ascending
    SharedSpan<TriangleRecord> triangles;    ///< in the imported file's order
    SharedSpan<glm::uvec4> triangleVertices; ///< per triangle: three vertex indices, material
    SharedSpan<std::uint32_t> normals;       ///< per vertex, octEncode()d
    SharedSpan<glm::vec2> texcoords;         ///< per vertex; empty if no material has an image
    SharedSpan<Material> materials;
    SharedSpan<Light> lights;
    SharedSpan<ImagePlace> images;
    SharedSpan<std::uint32_t>
        pages; ///< pageCount * pageHeight * pageWidth RGBA8 sRGB texels, R in the lowest byte

    std::uint64_t voxelCount() const { return std::uint64_t(grid.dims.x) * grid.dims.y * grid.dims.z; }
};

/// Throws Error{InvalidContent}, message prefixed by `name`, unless every count, index and number is in
/// range.
void validate(const Atlas& atlas, const std::string& name);

} // namespace rt
