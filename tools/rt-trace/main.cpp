#include "common/binary_io.h"
#include "common/run_tool.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/listings.h"
#include "tools/rt-trace/merge_command.h"
#include "tools/rt-trace/options.h"
#include "tools/rt-trace/trace_rays.h"
#include "tools/rt-trace/trace_scene.h"

#include <string_view>

namespace {

void trace(const rt::TraceOptions& options) {
    const rt::TraceRecipes recipes = rt::recipesOf(options);
    if (!rt::isUpToDate(options, recipes)) {
        if (options.raysPath.empty())
            rt::traceScene(options, recipes);
        else
            rt::traceRays(options, recipes.own);
    }
    std::vector<std::string> files;
    for (const rt::InputFile& input : rt::inputsOf(options)) files.push_back(input.path);
    rt::writeDependencies(options.common, rt::outputsOf(options), files);
}

int body(int argc, const char* const* argv) {
    if (argc > 1 && argv[1] == std::string_view("merge")) return rt::mergeCommand(argc - 1, argv + 1);
    const std::optional<rt::TraceOptions> options = rt::parseTraceOptions(argc, argv);
    if (!options) return 0;
    rt::prepareGlEnvironment(options->common.threads);
    for (const std::string& path : rt::outputsOf(*options)) rt::requireWritable(path);
    if (options->listDevices)
        rt::printDevices(*options);
    else if (options->listCameras)
        rt::printCameras(*options);
    else
        trace(*options);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    return rt::runTool("rt-trace", argc, argv, body);
}
