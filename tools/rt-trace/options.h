#pragma once
#include "common/command_line.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/lights.h"
#include "tools/rt-trace/ray_order.h"

#include <optional>
#include <string>
#include <vector>

namespace rt {

/// What the command line of rt-trace asks for.
struct TraceOptions {
    CommonOptions common;
    bool listDevices = false;
    std::string device = "auto";
    std::string scenePath;
    std::vector<std::string> outputPaths;
    bool stats = false;
    bool doublePrecision = false;
    unsigned intersect = kIntersectWatertight;

    // Pictures.
    glm::uvec2 size{512, 512};
    CameraRequest camera;
    std::vector<LightRequest> lights;
    glm::vec3 ambient{0.0f};
    glm::vec3 background{0.0f};
    unsigned maxDepth = 4;
    bool reproducible = false;

    // Ray queries.
    std::string raysPath; ///< empty: a picture is wanted
    bool anyHit = false;
    RayOrder rayOrder = RayOrder::Auto;
    unsigned repeat = 0; ///< 0: trace once, without warming the device up
};

/// Every file that the tool is to write, "-" for standard output.
std::vector<std::string> outputsOf(const TraceOptions& options);

/// Returns nothing when --help or --version was asked for and printed. Throws Error{Usage}.
std::optional<TraceOptions> parseTraceOptions(int argc, const char* const* argv);

} // namespace rt
