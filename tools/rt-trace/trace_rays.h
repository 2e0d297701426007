#pragma once
#include "tools/rt-trace/options.h"

namespace rt {

/// Traces the rays of a file and writes their hits, and the JSON file if it was asked for.
/// Throws Error{InvalidContent} unless the file is a whole number of rays.
void traceRays(const TraceOptions& options);

} // namespace rt
