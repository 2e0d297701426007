#pragma once
#include "formats/mesh.h"
#include "formats/recipe.h"

#include <string>

namespace rt {

/// Writes a .rtmesh, whole or not at all, and the files `beside` it, all of them or none. Throws
/// Error{FileAccess}.
void writeMesh(const std::string& path, const Mesh& mesh, const Recipe& recipe = {},
               const std::vector<OutputFile>& beside = {});

struct MeshFile {
    Mesh mesh; ///< views the mapped file, which lives as long as any of its spans
    std::uint64_t contentHash;
};

/// Maps and validates a .rtmesh. Safe for untrusted files. Throws Error{FileAccess} or Error{InvalidContent};
/// messages call it `shownAs`, if that is given.
MeshFile readMesh(const std::string& path, const std::string& shownAs = "");

} // namespace rt
