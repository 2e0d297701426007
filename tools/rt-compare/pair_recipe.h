#pragma once
#include "formats/recipe.h"
#include "tools/rt-compare/compare_files.h"

namespace rt {

/// Every file that is read for these pairs.
std::vector<std::string> inputsOf(const Options& options, const std::vector<FilePair>& pairs);

/// What the verdict on these pairs is made of. The names of files count, as reports have them.
Recipe recipeOf(const Options& options, const std::vector<FilePair>& pairs);

} // namespace rt
