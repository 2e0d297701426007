// Averages blocks of pixels, so that a picture of k times the size becomes one of k*k samples per pixel:
//     rt_box_filter large.exr -o small.exr --side 4
#include "common/command_line.h"
#include "common/run_tool.h"
#include "formats/image_exr.h"
#include "tests/bench/pixel_blocks.h"

#include <CLI/CLI.hpp>

namespace rt::bench {
namespace {

struct Options {
    CommonOptions common;
    std::string inputPath, outputPath;
    std::uint32_t side = 1;
};

bool parse(int argc, const char* const* argv, Options& options) {
    CLI::App app("Averages R, G, B and A of blocks of pixels", "rt_box_filter");
    addCommonOptions(app, options.common, "OpenEXR " RT_OPENEXR_VERSION);
    app.add_option("input", options.inputPath, "Input")->required()->type_name("FILE.exr");
    app.add_option("-o,--output", options.outputPath, "Output")->required()->type_name("FILE.exr");
    app.add_option("--side", options.side, "Of a block, in pixels")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    if (!parseCommandLine(app, argc, argv, options.common)) return false;
    requireDistinctPaths({options.inputPath}, {options.outputPath});
    return true;
}

int boxFilter(int argc, const char* const* argv) {
    Options options;
    if (!parse(argc, argv, options)) return 0;
    writeImage(options.outputPath,
               averageBlocks(readExr(options.inputPath), options.side, options.inputPath));
    return 0;
}

} // namespace
} // namespace rt::bench

int main(int argc, char** argv) {
    return rt::runTool("rt_box_filter", argc, argv, rt::bench::boxFilter);
}
