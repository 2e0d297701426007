#pragma once
#include "formats/recipe.h"
#include "tools/rt-compare/compare_files.h"
#include "tools/rt-compare/options.h"

#include <memory>
#include <nlohmann/json_fwd.hpp>

namespace rt {

/// Writes what is found out about pairs, one after the other, as the options ask for it.
class ReportFiles {
public:
    /// What passes carries the recipe; a comparison that fails has to run again. Throws Error{Usage} if a
    /// report that shows the pixels of one pair is wanted of several, or if one would overwrite a file to be
    /// compared.
    ReportFiles(const Options& options, const std::vector<FilePair>& pairs, const Recipe& recipe);
    ~ReportFiles();

    /// Prints the pair, and writes its error map and page.
    void add(const PairResult& result);
    /// Prints the summary and writes what is one file for all pairs.
    void finish();

private:
    const Options& options_;
    const Recipe& recipe_;
    bool printsText_;
    Totals totals_;
    std::unique_ptr<nlohmann::json> pairs_;
};

} // namespace rt
