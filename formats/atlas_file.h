#pragma once
#include "formats/atlas.h"

#include <string>

namespace rt {

/// Writes a .rtatlas, whole or not at all. Throws Error{FileAccess}.
void writeAtlas(const std::string& path, const Atlas& atlas);

struct AtlasFile {
    Atlas atlas; ///< views the mapped file, which lives as long as any of its spans
    std::uint64_t contentHash;
    std::uint64_t fileBytes;
};

/// Maps and validates a .rtatlas. Safe for untrusted files. Throws Error{FileAccess} or
/// Error{InvalidContent}.
AtlasFile readAtlas(const std::string& path);

} // namespace rt
