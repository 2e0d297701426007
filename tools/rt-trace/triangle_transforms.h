#pragma once
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"

#include <span>
#include <vector>

namespace rt {

/// Baldwin & Weber 2016: for each triangle the affine map that takes its plane to z = 0 and its corners to
/// (0,0), (1,0) and (0,1). Of the maps that do, the one that leaves out the axis along which the normal is
/// longest: one column of each row is then 0 or 1. Computed in double, rounded to float. Not finite for
/// triangles without an area.
std::vector<TriangleTransform> triangleTransforms(std::span<const TriangleRecord> triangles);
/// The same, not rounded.
std::vector<TriangleTransformDouble> triangleTransformsDouble(std::span<const TriangleRecord> triangles);

} // namespace rt
