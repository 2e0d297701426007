#include "tools/rt-trace/options.h"

#include "common/error.h"
#include "formats/image.h"
#include "tools/rt-trace/environment.h"
#include "tools/rt-trace/picture_options.h"
#include "tools/rt-trace/trace_recipe.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace rt {
namespace {

constexpr const char* kQueryGroup = "Ray queries";
constexpr const char* kDeviceVariable = "RT_DEVICE";

// In the order of their constants.
constexpr std::array<const char*, 3> kIntersectNames = {"watertight", "moller-trumbore", "baldwin-webber"};

// Options whose text is parsed once all of them are known.
struct OptionTexts {
    PictureTexts picture;
    std::string device = "auto";
    std::string rayOrder = "auto";
    std::string maxGpuMemory;
    std::string precision = "float";
    std::string intersect = kIntersectNames[0];
};

void addQueryOptions(CLI::App& app, TraceOptions& options, OptionTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--rays", options.raysPath,
                       "Trace these rays: float32 origin, tmin, direction, tmax each; -o gets "
                       "t, u, v, triangle each")
            ->type_name("FILE"),
        app.add_flag("--any-hit", options.anyHit, "Any hit will do, not the nearest"),
        app.add_option(
               "--ray-order", texts.rayOrder,
               "Whether neighbours among the rays go about the same way; auto looks at a sample. The hits "
               "are the same")
            ->check(CLI::IsMember({"auto", "coherent", "scattered"}).description(""))
            ->type_name("auto|coherent|scattered")
            ->capture_default_str(),
    };
    for (CLI::Option* option : added) option->group(kQueryGroup);
}

void addDeviceOptions(CLI::App& app, TraceOptions& options, OptionTexts& texts) {
    app.add_option(
           "--device", texts.device,
           fmt::format("auto (hardware first), software, an index of --list-devices, or the number that "
                       "CUDA gives the device; else what the environment variable {} says",
                       kDeviceVariable))
        ->type_name("auto|software|N|cuda:N")
        ->capture_default_str();
    app.add_flag("--list-devices", options.listDevices, "Print the devices and which of them can be used");
    app.add_flag("--list-cameras", options.listCameras, "Print the scene's cameras");
    app.add_flag("--explain", options.explain,
                 "Print what the shader is compiled for, and why, and which parts of the atlas the device "
                 "gets; without -o nothing else is done");
    app.add_option("--precision", texts.precision,
                   "Compute with 32 or 64 bits; double is slow, and the reference for errors of float. With "
                   "--rays the "
                   "hits are then float64 t, u, v, uint32 triangle, uint32 0")
        ->check(CLI::IsMember({"float", "double"}).description(""))
        ->type_name("float|double")
        ->capture_default_str();
    app.add_option("--intersect", texts.intersect,
                   "Triangle test; the others than watertight lose rays that meet edges")
        ->check(CLI::IsMember({kIntersectNames[0], kIntersectNames[1], kIntersectNames[2]}).description(""))
        ->type_name(fmt::format("{}", fmt::join(kIntersectNames, "|")))
        ->capture_default_str();
    app.add_option("--max-gpu-memory", texts.maxGpuMemory,
                   "Most that the device's memory is to hold; the scene and the picture are added up before "
                   "anything is uploaded; else what the driver says is free")
        ->type_name("SIZE[K|M|G]");
    app.add_flag("--no-shader-cache", options.noShaderCache,
                 "Compile anew, and keep nothing in ~/.cache/rt-tools (or $XDG_CACHE_HOME/rt-tools)");
    app.add_option("--repeat", options.repeat,
                   "Warm the device up, trace the picture or the rays N times and report the median time")
        ->check(numberBetween(1, 100000))
        ->type_name("N");
    app.add_flag("--stats", options.stats, "Count rays, steps and triangle tests in a second pass");
}

// Options of pictures and of ray queries do not mix, nor with lists.
void checkGroups(const CLI::App& app, const TraceOptions& options) {
    const bool query = !options.raysPath.empty();
    const char* const list = options.listDevices   ? "--list-devices"
                             : options.listCameras ? "--list-cameras"
                                                   : nullptr;
    for (const CLI::Option* option : app.get_options()) {
        const bool ofPictures = option->get_group().rfind(kPictureGroup, 0) == 0;
        const bool makesSomething = ofPictures || option->get_group() == kQueryGroup ||
                                    option->get_name() == "--output" || option->get_name() == "--repeat" ||
                                    option->get_name() == "--depfile" || option->get_name() == "--if-changed";
        if (list && makesSomething && option->count() > 0)
            throw Error(ErrorKind::Usage, fmt::format("{} does not go with {}", option->get_name(), list));
        if (option->count() > 0 && (query ? ofPictures : option->get_group() == kQueryGroup))
            throw Error(ErrorKind::Usage, fmt::format("{} {} --rays", option->get_name(),
                                                      query ? "does not go with" : "needs"));
    }
}

void convertTexts(const CLI::App& app, const OptionTexts& texts, TraceOptions& options) {
    convertPictureTexts(app, texts.picture, options);
    if (!texts.maxGpuMemory.empty())
        options.maxGpuMemory = parseByteSize(texts.maxGpuMemory, "--max-gpu-memory");
    options.doublePrecision = texts.precision == "double";
    options.intersect = static_cast<unsigned>(
        std::find(kIntersectNames.begin(), kIntersectNames.end(), texts.intersect) - kIntersectNames.begin());
    if (options.doublePrecision && options.kernel == Kernel::Multipass)
        throw Error(ErrorKind::Usage,
                    "--precision double does not go with --kernel multipass, whose textures "
                    "hold rays as floats; use --kernel compute");
    if (texts.rayOrder == "coherent") options.rayOrder = RayOrder::Coherent;
    if (texts.rayOrder == "scattered") options.rayOrder = RayOrder::Scattered;
}

// What schedulers that start several runs side by side set for each; empty is as good as not set.
DeviceRequest chooseDevice(const CLI::App& app, const OptionTexts& texts) {
    const char* const variable = std::getenv(kDeviceVariable);
    const bool isVariable = app.get_option("--device")->count() == 0 && variable && *variable;
    return isVariable ? parseDevice(variable, kDeviceVariable) : parseDevice(texts.device, "--device");
}

void checkPaths(const TraceOptions& options) {
    if (options.scenePath.empty()) throw Error(ErrorKind::Usage, "no scene was named; see rt-trace --help");
    if (options.listCameras) return;
    if (options.outputPaths.empty() && !options.explain)
        throw Error(ErrorKind::Usage, "no output was named; add -o FILE");
    const bool goesOn = options.resumePath == options.checkpointPath; // then both are one file
    const bool environmentFile = isEnvironmentFile(options.environment);
    requireDistinctPaths({options.scenePath, options.raysPath, options.cameraPath,
                          environmentFile ? options.environment : std::string(),
                          goesOn ? std::string() : options.resumePath},
                         outputsOf(options));
    if (!options.raysPath.empty()) {
        if (options.outputPaths.size() != 1) throw Error(ErrorKind::Usage, "--rays goes with one -o only");
        if (options.scenePath == "-" && options.raysPath == "-")
            throw Error(ErrorKind::Usage, "the scene and the rays cannot both come from standard input");
        return;
    }
    for (const std::string& path : options.outputPaths)
        if (!imageFileType(path))
            throw Error(ErrorKind::Usage, fmt::format("-o {}: pictures end in .exr or .png", path));
}

void checkBuild(const TraceOptions& options) {
    if (options.common.ifChanged && options.explain)
        throw Error(ErrorKind::Usage, "--if-changed does not go with --explain, which prints every time");
    if (options.common.ifChanged && !options.raysPath.empty() && options.common.jsonPath.empty())
        throw Error(ErrorKind::Usage,
                    "--if-changed with --rays needs --json FILE, which says what the hits were made of");
    if (!options.listCameras)
        checkBuildOptions(options.common, {options.scenePath, options.raysPath, options.cameraPath},
                          outputsOf(options));
}

} // namespace

std::vector<std::string> outputsOf(const TraceOptions& options) {
    std::vector<std::string> paths;
    for (const std::string& path : options.outputPaths)
        paths.push_back(options.frames ? framePath(path, options.frames->first).value_or(path) : path);
    if (!options.checkpointPath.empty()) paths.push_back(options.checkpointPath);
    for (const std::string& path : {options.common.jsonPath, options.common.depfilePath})
        if (!path.empty()) paths.push_back(path);
    // Whoever wants JSON on standard output gets nothing else there.
    const bool text = options.explain || options.listDevices || options.listCameras;
    if (text && options.common.jsonPath != "-") paths.push_back("-");
    return paths;
}

std::optional<TraceOptions> parseTraceOptions(int argc, const char* const* argv) {
    CLI::App app("Traces pictures or rays through an atlas, on a GPU or on Mesa's software renderer.\n"
                 "Another command: rt-trace merge --help (puts the shards of a picture together).",
                 "rt-trace");
    TraceOptions options;
    OptionTexts texts;
    app.add_option("scene", options.scenePath,
                   "The .rtatlas to trace, - for standard input; required but for --list-devices")
        ->type_name("FILE");
    app.add_option("-o,--output", options.outputPaths,
                   "A picture, .exr or .png (repeatable), or the hits of --rays")
        ->type_name("FILE")
        ->expected(1)
        ->allow_extra_args(false)
        ->take_all();
    addPictureOptions(app, options, texts.picture);
    addQueryOptions(app, options, texts);
    addDeviceOptions(app, options, texts);
    addCommonOptions(app, options.common,
                     fmt::format("libepoxy {}, OpenEXR {}", RT_EPOXY_VERSION, RT_OPENEXR_VERSION));
    addBuildOptions(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    checkGroups(app, options);
    if (options.listDevices) return options;
    options.device = chooseDevice(app, texts);
    convertTexts(app, texts, options);
    checkPaths(options);
    checkBuild(options);
    options.common.making = makingOf(app, options, false);
    if (options.shard && options.shard->kind == ShardKind::Parts)
        options.wholeMaking = makingOf(app, options, true);
    return options;
}

} // namespace rt
