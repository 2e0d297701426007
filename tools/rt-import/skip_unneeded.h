#pragma once
#include "formats/material.shared.h"
#include "tools/rt-import/load_images.h"
#include "tools/rt-import/read_scene.h"

#include <span>

namespace rt {

/// Something of a file that no picture needs.
struct LeftOut {
    const char* what; ///< as the report names it
    std::uint64_t count = 0;
    std::uint64_t bytes = 0; ///< that it would take in memory
};

/// Vertices that no triangle uses.
LeftOut countUnusedVertices(const SceneSoup& soup);

/// Sets of texture coordinates that no texture uses, each with its mesh.
LeftOut countUnusedTexcoords(const std::vector<MeshInstance>& instances, const SoupOptions& used);

/// Images inside the file that no material of a triangle uses.
LeftOut countUnusedTextures(const aiScene& scene, std::span<const MaterialSource> materials);

/// Takes away the triangles that nothing shows, for their materials let everything through; all stay if
/// nothing else is there. Triangles name their material by its place in `materials`.
LeftOut dropInvisible(std::span<const Material> materials, SceneSoup& soup);

/// Takes away the materials that no triangle uses, and renumbers the others. Returns how many went.
std::uint64_t dropUnusedMaterials(std::vector<std::uint32_t>& triangleMaterial,
                                  std::vector<Material>& materials);

/// Takes away images that no material uses and those whose pixels another one has too, and renumbers the
/// others.
LeftOut dropUnusedImages(std::vector<Material>& materials, LoadedImages& loaded);

/// One warning for each kind of thing that Assimp read and that has no place in a mesh.
void warnOfLost(const aiScene& scene, std::vector<std::string>& warnings);

} // namespace rt
