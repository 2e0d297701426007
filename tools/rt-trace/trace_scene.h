#pragma once
#include "tools/rt-trace/trace_recipe.h"

namespace rt {

/// Renders the scene and writes the pictures and the JSON file that were asked for.
void traceScene(const TraceOptions& options, const TraceRecipes& recipes);

} // namespace rt
