#pragma once
#include "formats/atlas.h"
#include "formats/mesh.h"
#include "tools/rt-grid/fresh_array.h"

namespace rt {

/// World space to atlas space: atlas = (world - offset) * scale.
struct Rebase {
    glm::vec3 offsetWorld{0.0f};
    float scale = 1.0f; ///< a power of two, 2^-120 to 2^120
};

/// boundsOf() on all cores.
Bounds sceneBounds(const Mesh& mesh);

/// Chooses a rebase that makes the largest extent of `bounds` 0.5 to 1 and rounds no vertex inside them. On
/// an axis whose numbers stay within a factor of two of each other any float between them subtracts exactly
/// (Sterbenz 1974), so the one nearest the middle is taken; on all other axes nothing is subtracted, and no
/// number exceeds twice the extent. Only numbers that the scale takes below 2^-126 can lose digits.
Rebase chooseRebase(const Bounds& bounds);

/// Returns the mesh's triangles in atlas space, in the mesh's order; the bits of v0.w are the triangle's
/// index.
FreshArray<TriangleRecord> rebaseTriangles(const Mesh& mesh, const Rebase& rebase);

} // namespace rt
