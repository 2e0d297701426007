#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/run_tool.h"
#include "formats/image_exr.h"
#include "tools/rt-compare/metrics.h"
#include "tools/rt-compare/report.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace rt {
namespace {

struct Options {
    CommonOptions common;
    std::string pathA, pathB;
    double maxRmse = 0.0;
};

bool parse(int argc, const char* const* argv, Options& options) {
    CLI::App app("Compares two EXR images; exit code 0 if they agree, 1 if they differ", "rt-compare");
    addCommonOptions(app, options.common, "OpenEXR " RT_OPENEXR_VERSION);
    app.add_option("a", options.pathA, "First image (.exr); - for standard input")
        ->required()
        ->type_name("A.exr");
    app.add_option("b", options.pathB, "Second image (.exr)")->required()->type_name("B.exr");
    app.add_option("--max-rmse", options.maxRmse,
                   "Largest root mean square error over R, G, B, A that passes, in linear units (default 0)")
        ->type_name("X");
    if (!parseCommandLine(app, argc, argv, options.common)) return false;
    if (!std::isfinite(options.maxRmse) || options.maxRmse < 0.0)
        throw Error(ErrorKind::Usage,
                    fmt::format("--max-rmse: {} is not a finite number >= 0", options.maxRmse));
    if (options.pathA == "-" && options.pathB == "-")
        throw Error(ErrorKind::Usage, "standard input holds one image; name a file for the other");
    return true;
}

int compare(int argc, const char* const* argv) {
    Options options;
    if (!parse(argc, argv, options)) return 0;
    const Image a = readExr(options.pathA);
    const Image b = readExr(options.pathB);
    const Comparison comparison = compareImages(a, b, options.maxRmse);
    const ComparedFiles files{options.pathA, options.pathB, a, b, options.maxRmse};
    if (!options.common.jsonPath.empty()) writeJson(options.common.jsonPath, jsonReport(files, comparison));
    if (!options.common.quiet && options.common.jsonPath != "-")
        writeFile("-", textReport(files, comparison));
    return comparison.passed() ? 0 : kExitImagesDiffer;
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-compare", argc, argv, rt::compare);
}
