#pragma once
#include "common/command_line.h"
#include "tools/rt-import/guard_process.h"
#include "tools/rt-import/import_model.h"

#include <string>
#include <vector>

namespace rt {

struct ImportOptions {
    CommonOptions common;
    SceneSources sources;
    std::string outputPath;
    ImportSettings settings;
    GuardLimits limits;
    bool listFormats = false; ///< and nothing else
};

/// Returns false when --help or --version was asked for and printed. Throws Error{Usage}.
bool parseImportOptions(int argc, const char* const* argv, ImportOptions& options);

/// Every file that a run with these options writes; "-" is standard output.
std::vector<std::string> outputsOf(const ImportOptions& options);

} // namespace rt
