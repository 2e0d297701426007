#include "common/binary_io.h"
#include "common/log.h"
#include "common/run_tool.h"
#include "formats/atlas_file.h"
#include "tools/rt-trace/explain.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/options.h"
#include "tools/rt-trace/trace_rays.h"
#include "tools/rt-trace/trace_scene.h"

#include <fmt/format.h>

namespace {

void printDevices() {
    std::string text;
    for (const rt::GlDevice& device : rt::listGlDevices()) {
        const char* const kind = device.software ? "software" : "hardware";
        if (device.problem.empty())
            text += fmt::format("{}  {}  {}  GL {}  {}\n", device.index, kind, device.renderer,
                                device.version, device.driver);
        else
            text += fmt::format("{}  {}  cannot be used: {}\n", device.index, kind, device.problem);
    }
    rt::writeFile("-", text);
}

void printCameras(const std::string& path) {
    const rt::AtlasFile file = rt::readAtlas(path);
    if (file.atlas.cameras.empty()) rt::logInfo(path + ": has no cameras");
    rt::writeFile("-", rt::cameraList(file.atlas));
}

int body(int argc, const char* const* argv) {
    const std::optional<rt::TraceOptions> options = rt::parseTraceOptions(argc, argv);
    if (!options) return 0;
    rt::prepareGlEnvironment(options->common.threads);
    if (options->listDevices) {
        printDevices();
        return 0;
    }
    if (options->listCameras) {
        printCameras(options->scenePath);
        return 0;
    }
    for (const std::string& path : rt::outputsOf(*options)) rt::requireWritable(path);
    if (options->raysPath.empty())
        rt::traceScene(*options);
    else
        rt::traceRays(*options);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    return rt::runTool("rt-trace", argc, argv, body);
}
