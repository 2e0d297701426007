#pragma once
#include "common/command_line.h"
#include "tools/rt-trace/aovs.h"
#include "tools/rt-trace/camera.h"
#include "tools/rt-trace/device_choice.h"
#include "tools/rt-trace/frame_range.h"
#include "tools/rt-trace/lights.h"
#include "tools/rt-trace/ray_order.h"
#include "tools/rt-trace/shard.h"
#include "tools/rt-trace/tone_map.h"

#include <optional>
#include <string>
#include <vector>

namespace rt {

enum class Heat { None, Steps, Tests, Time };
enum class Kernel { Compute, Multipass };

/// What the command line of rt-trace asks for.
struct TraceOptions {
    CommonOptions common;
    std::string wholeMaking; ///< makingOf() the whole picture that a shard is a part of; else empty
    bool listDevices = false;
    bool listCameras = false;
    bool explain = false;
    DeviceRequest device;
    bool noShaderCache = false;
    std::optional<std::uint64_t> maxGpuMemory; ///< bytes
    std::string scenePath;
    std::vector<std::string> outputPaths;
    bool stats = false;
    unsigned repeat = 0; ///< 0: trace once, without warming the device up
    bool doublePrecision = false;
    unsigned intersect = kIntersectWatertight;

    // Pictures.
    glm::uvec2 size{512, 512};
    glm::uvec4 window{0, 0, 512, 512}; ///< [xy, zw): all of it, or --crop, or the shard's part of that
    CameraRequest camera;
    std::vector<LightRequest> lights;
    std::optional<glm::vec3> ambient;      ///< else 0.1, or none with an environment
    double occlusion = 0.0;                ///< world units; 0: ambient light is not hidden
    std::optional<glm::vec3> background;   ///< else the scene's, or a blue grey
    std::string environment;               ///< a file, G or R,G,B; empty: the scene's, if it has one
    std::optional<double> environmentTurn; ///< degrees about +y; else the scene's
    std::optional<double> environmentStrength;
    unsigned maxDepth = 4;
    Kernel kernel = Kernel::Compute;
    bool reproducible = false;

    // Samples.
    unsigned samples = 1;    ///< per pixel, of all shards together
    SampleRange range{0, 1}; ///< all of them, or the shard's
    std::uint32_t seed = 0;
    unsigned filter = kFilterBox;
    double filterRadius = 0.5;     ///< pixels
    double timeLimitSeconds = 0.0; ///< 0: none
    double targetError = 0.0;      ///< 0: none

    // What is written.
    unsigned aovs = kDefaultAovs; ///< kAov...
    ToneMap toneMap = ToneMap::None;
    double exposureStops = 0.0;
    Heat heat = Heat::None;
    double heatMost = 0.0; ///< 0: that of the picture
    std::string checkpointPath, resumePath;
    std::optional<FrameRange> frames;
    std::string cameraPath;
    unsigned turntable = 0; ///< frames of a full turn; 0: none
    std::optional<Shard> shard;
    glm::uvec4 wholeWindow{0, 0, 512, 512}; ///< `window` of all shards together

    // Ray queries.
    std::string raysPath; ///< empty: a picture is wanted
    bool anyHit = false;
    RayOrder rayOrder = RayOrder::Auto;
};

/// Every file that the tool is to write, "-" for standard output; of a range of frames those of the first.
std::vector<std::string> outputsOf(const TraceOptions& options);

/// Returns nothing when --help or --version was asked for and printed. Throws Error{Usage}.
std::optional<TraceOptions> parseTraceOptions(int argc, const char* const* argv);

} // namespace rt
