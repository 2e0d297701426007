#pragma once
#include "common/command_line.h"
#include "tools/rt-compare/compare.h"
#include "tools/rt-compare/report_options.h"

#include <string>
#include <vector>

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

/// Every file that a run with these options writes; "-" is standard output.
std::vector<std::string> outputsOf(const Options& options);

/// Returns false when --help or --version was asked for and printed. Throws Error{Usage}.
bool parseOptions(int argc, const char* const* argv, Options& options);

} // namespace rt
