#pragma once
#include "common/command_line.h"
#include "tools/rt-compare/compare.h"
#include "tools/rt-compare/report_options.h"

#include <string>

namespace rt {

struct Options {
    CommonOptions common;
    std::string pathA, pathB, listPath;
    std::string maskPath, secondPath; ///< empty: none
    bool selfTest = false;
    CompareOptions compare;
    PictureLimits reading{.allCompressionsOption = "--allow-compression all"};
    ReportOptions reports;
};

/// Returns false when --help or --version was asked for and printed. Throws Error{Usage}.
bool parseOptions(int argc, const char* const* argv, Options& options);

} // namespace rt
