#pragma once
#include "formats/atlas.h"
#include "formats/recipe.h"

#include <memory>
#include <string>

namespace rt {

class SectionFile;

/// Writes a .rtatlas, whole or not at all. Throws Error{FileAccess}.
void writeAtlas(const std::string& path, const Atlas& atlas, const Recipe& recipe = {});

struct AtlasFile {
    Atlas atlas; ///< views the mapped file, which lives as long as any of its spans
    std::uint64_t contentHash;
    std::uint64_t fileBytes;
};

/// A .rtatlas that is mapped and not yet checked beyond its frame and table.
class MappedAtlas {
public:
    /// Throws Error{FileAccess} or Error{InvalidContent}.
    explicit MappedAtlas(const std::string& path);
    ~MappedAtlas();

    /// Every array can be read; nothing in it may be believed. validateSizes() tells whether their sizes
    /// agree.
    const AtlasFile& unverified() const { return file_; }
    /// Checks hashes and contents on all cores. Safe for untrusted files. Throws Error{InvalidContent}.
    void verify() const;

private:
    std::string path_;
    std::unique_ptr<const SectionFile> sections_;
    AtlasFile file_;
};

/// Maps and verifies a .rtatlas. Throws as MappedAtlas does.
AtlasFile readAtlas(const std::string& path);

} // namespace rt
