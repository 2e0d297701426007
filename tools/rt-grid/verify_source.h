#pragma once
#include "formats/atlas.h"
#include "formats/mesh_file.h"
#include "tools/rt-grid/faults.h"

namespace rt {

/// Whether the atlas holds the mesh's scene: the same triangles, moved and scaled without rounding, the same
/// vertices' normals and texture coordinates, materials, lights, cameras and images, and the mesh's hash.
/// Both must have passed validate().
Faults verifySource(const Atlas& atlas, const MeshFile& mesh, WorkMeter& meter);

/// Whether INFO's bounds are those of the triangles.
Faults verifyBounds(const Atlas& atlas);

} // namespace rt
