#pragma once
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/bin_triangles.h"
#include "tools/rt-grid/pack_textures.h"
#include "tools/rt-grid/place_grid.h"
#include "tools/rt-grid/rebase_scene.h"

namespace rt {

/// What the stages before packing made of a mesh.
struct GridStages {
    Rebase rebase;
    std::vector<TriangleRecord> triangles;
    GridLayout layout;
    CellRefs refs; ///< with distances in empty voxels for a cloud
    PageLayout pages;
};

/// Whether a surface of the mesh shows an image: only then do texture coordinates and images go into the
/// atlas.
bool showsImages(const Mesh& mesh);

/// Puts an atlas together. `structure` is kStructureUniform or kStructureCloud. What needs no conversion is
/// shared with the mesh, not copied.
Atlas packAtlas(const MeshFile& meshFile, std::uint32_t structure, GridStages stages);

} // namespace rt
