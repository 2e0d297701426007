#pragma once
#include "tools/rt-import/ledger.h"
#include "tools/rt-import/skip_unneeded.h"
#include "tools/rt-import/surface_topology.h"

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rt {

class StageTimer;
struct Mesh;

/// What the import did to the file's content, beyond the mesh itself.
struct ImportReport {
    Ledger ledger;                      ///< what was mended
    std::vector<std::string> warnings;  ///< what was lost: one line each, in the order found
    std::vector<LeftOut> leftOut;       ///< what nothing needs
    SurfaceFigures surface;             ///< of what is left
    std::uint64_t weldedVertices = 0;   ///< distinct positions of the file
    std::uint64_t movedVertices = 0;    ///< of these, those that --weld joined to others
    std::uint64_t generatedNormals = 0; ///< triangle corners for which the file had no usable normal
    std::uint64_t decimatedFrom = 0;    ///< triangles before the decimation; 0 = there was none
};

/// Bytes of all arrays of the mesh.
std::uint64_t byteCount(const Mesh& mesh);
/// Bytes of all that was left out.
std::uint64_t byteCount(const std::vector<LeftOut>& leftOut);

/// What is only told where details are asked for: what the surface is like, what was left out.
std::vector<std::string> detailLines(const ImportReport& report);

/// The --json document.
nlohmann::json toJson(const ImportReport& report, const Mesh& mesh, const StageTimer& timer);

} // namespace rt
