#pragma once
#include "formats/recipe.h"
#include "tools/rt-import/files_asked.h"
#include "tools/rt-import/import_options.h"

#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What an import is made of: tool, options, inputs, and behind these, once they are known, the files that
/// they led to.
class ImportRecipe {
public:
    /// Hashes the inputs.
    explicit ImportRecipe(const ImportOptions& options);

    /// Whether --if-changed is given and finds nothing changed: by the list of files that the old mesh has.
    /// If so, says it, and writes the dependency file, which build tools take away.
    bool isUpToDate() const;

    Recipe with(const std::string& filesAsked) const;
    /// Those that were found.
    std::vector<std::string> found(const std::string& filesAsked) const { return asked_.found(filesAsked); }
    /// Nothing without --depfile.
    std::optional<std::string> dependencies(const std::string& filesAsked) const;

private:
    const ImportOptions& options_;
    FilesAsked asked_;
    Recipe inputs_;
};

} // namespace rt
