#pragma once
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/pack_textures.h"
#include "tools/rt-grid/place_grid.h"
#include "tools/rt-grid/rebase_scene.h"

namespace rt {

/// The words of an atlas, as atlas.shared.h describes them for its structure.
struct VoxelWords {
    std::vector<std::uint32_t> voxels;
    SharedSpan<std::uint32_t> bricks; ///< none but for kStructureNested
    SharedSpan<std::uint32_t> references;
    std::uint64_t occupiedVoxels = 0;
    std::uint64_t referenceCount = 0;
};

/// What the stages before packing made of a mesh.
struct GridStages {
    Rebase rebase;
    Bounds worldBounds;
    FreshArray<TriangleRecord> triangles;
    GridLayout layout;
    VoxelWords words;
    PageLayout pages;
};

/// Whether a surface of the mesh shows an image: only then do texture coordinates and images go into the
/// atlas.
bool showsImages(const Mesh& mesh);

/// Puts an atlas together. What needs no conversion is
/// shared with the mesh, not copied.
Atlas packAtlas(const MeshFile& meshFile, std::uint32_t structure, GridStages stages);

} // namespace rt
