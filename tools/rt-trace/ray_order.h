#pragma once
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"

#include <span>

namespace rt {

/// How neighbours among the rays relate: they go about the same way, or each its own.
enum class RayOrder { Auto, Coherent, Scattered };

/// True if most runs of 32 rays, as a GPU traces them side by side, start more than an eighth of the scene's
/// size apart or point in different directions (length of their mean below 0.9). A sample of the runs
/// decides. Fewer than 32 rays are never scattered.
bool areScattered(std::span<const QueryRay> rays, const GridParams& grid);

} // namespace rt
