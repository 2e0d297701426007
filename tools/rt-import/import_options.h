#pragma once
#include "common/command_line.h"

#include <string>

namespace rt {

struct ImportOptions {
    CommonOptions common;
    std::string modelPath;
    std::string outputPath;
    double creaseDegrees = 45.0;
};

/// Returns false when --help or --version was asked for and printed. Throws Error{Usage}.
bool parseImportOptions(int argc, const char* const* argv, ImportOptions& options);

} // namespace rt
