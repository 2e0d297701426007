#pragma once
#include "formats/recipe.h"
#include "tools/rt-trace/options.h"

namespace rt {

/// Traces the rays of a file and writes their hits, and the JSON file, with the recipe, if it was asked for.
/// Throws Error{InvalidContent} unless the file is a whole number of rays.
void traceRays(const TraceOptions& options, const Recipe& recipe);

} // namespace rt
