#pragma once
#include "common/command_line.h"
#include "tools/rt-grid/build_atlas.h"

#include <optional>

namespace rt {

struct GridOptions {
    std::string meshPath;
    std::string atlasPath;
    std::string vdbPath; ///< empty = none
    BuildOptions build;
    CommonOptions common;
};

/// Parses rt-grid's command line. Returns nothing when --help or --version was asked for and printed.
/// Throws Error{Usage}.
std::optional<GridOptions> parseGridOptions(int argc, const char* const* argv);

/// Every file that a run with these options writes; "-" is standard output.
std::vector<std::string> outputsOf(const GridOptions& options);

/// Parses "N" (longest side) or "XxYxZ" into `request`. Throws Error{Usage}.
void parseResolution(const std::string& text, ResolutionRequest& request);

} // namespace rt
