#pragma once
#include "tools/rt-import/ledger.h"
#include "tools/rt-import/surface_topology.h"
#include "tools/rt-import/weld_vertices.h"

#include <functional>
#include <optional>
#include <string>

namespace rt {

inline constexpr double kUsualCrease = 45.0; // degrees

struct RepairOptions {
    double weldDistance = 0.0;                  ///< world units; positions that are closer become one
    std::optional<double> creaseDegrees = {};   ///< none: kUsualCrease, and 3DS files may be flat
    double decimateRatio = 1.0;                 ///< which part of the triangles is wanted
    std::uint64_t maxTriangles = kMaxSoupCount; ///< more are decimated to this
};

struct RepairedSurface {
    Weld weld;                            ///< of the repaired soup
    std::vector<glm::vec3> cornerNormals; ///< three per triangle; empty if the soup has all it needs
    SurfaceFigures figures;
    std::uint64_t generatedNormals = 0; ///< triangle corners for which the soup had no usable one
    std::uint64_t decimatedFrom = 0;    ///< triangles before the decimation; 0 = there was none
};

/// Welds positions, drops faces that have no area or repeat another one, turns faces as their neighbours are,
/// decimates, and generates the normals that are missing. What it finds goes into `ledger`. Throws
/// Error{InvalidContent} if no triangle is left or the scene is too wide for 32-bit floats, and
/// Error{LimitExceeded} if decimation cannot reach options.maxTriangles; messages prefixed by `path`.
/// `progress` is told which part is done, 0 to 1.
RepairedSurface repairSoup(SceneSoup& soup, const RepairOptions& options, const std::string& path,
                           Ledger& ledger, const std::function<void(double)>& progress);

} // namespace rt
