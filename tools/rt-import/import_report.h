#pragma once
#include "common/bounds.h"

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rt {

class StageTimer;
struct Mesh;

/// What the import did to the file's content, beyond the mesh itself.
struct ImportReport {
    std::vector<std::string> warnings;     ///< one line each, in the order found
    std::uint64_t droppedFaces = 0;        ///< points and lines
    std::uint64_t weldedVertices = 0;      ///< distinct positions of the file
    std::uint64_t degenerateTriangles = 0; ///< kept, though their area is zero
    std::uint64_t nonManifoldFaces = 0;    ///< kept, though no halfedge mesh can hold them
    std::uint64_t generatedNormals = 0;    ///< triangle corners for which the file had no usable normal
};

/// Bytes of all arrays of the mesh.
std::uint64_t byteCount(const Mesh& mesh);

/// The --json document.
nlohmann::json toJson(const ImportReport& report, const Mesh& mesh, const StageTimer& timer);

} // namespace rt
