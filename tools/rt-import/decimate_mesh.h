#pragma once
#include "tools/rt-import/surface_topology.h"

#include <functional>

namespace rt {

struct SceneSoup;
struct Weld;

/// Takes edges of the surface away, those first whose loss moves it least (quadric error metrics, Garland and
/// Heckbert 1997), until it has `target` triangles or none can go without turning a face over. Vertices stay
/// where they are: corners move to a neighbour's. Borders count as surfaces that stand upright on them;
/// vertices stay at which materials, texture coordinates or surfaces that are not joined meet. Removes the
/// triangles from `soup`, whose normals no longer hold; `weld` and `surface` are its. `progress` is told
/// which part is done, 0 to 1.
void decimate(SceneSoup& soup, const Weld& weld, SplitSurface surface, std::size_t target,
              const std::function<void(double)>& progress);

} // namespace rt
