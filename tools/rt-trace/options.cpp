#include "tools/rt-trace/options.h"

#include "common/error.h"
#include "formats/image.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rt {
namespace {

constexpr const char* kPictureGroup = "Pictures";
constexpr const char* kQueryGroup = "Ray queries";

// In the order of their constants.
constexpr std::array<const char*, 3> kIntersectNames = {"watertight", "moller-trumbore", "baldwin-webber"};

// Options whose text is parsed once all of them are known.
struct OptionTexts {
    std::string size = "512x512";
    std::string ambient = "0.1";
    std::string background = "0.32,0.4,0.5";
    std::string rayOrder = "auto";
    std::string precision = "float";
    std::string intersect = kIntersectNames[0];
    std::string eye, lookAt, up;
    std::vector<std::string> lights;
};

glm::dvec3 parsePoint(const std::string& text, const char* option) {
    const std::vector<double> v = parseNumbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

glm::vec3 toColor(double r, double g, double b, const char* option) {
    if (std::min({r, g, b}) < 0.0)
        throw Error(ErrorKind::Usage, fmt::format("{}: colours are not negative", option));
    return glm::vec3(glm::dvec3(r, g, b));
}

std::size_t countNumbers(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
}

glm::vec3 parseColor(const std::string& text, const char* option) {
    if (countNumbers(text) == 1) {
        const double grey = parseNumbers(text, 1, option)[0];
        return toColor(grey, grey, grey, option);
    }
    const std::vector<double> v = parseNumbers(text, 3, option);
    return toColor(v[0], v[1], v[2], option);
}

LightRequest parseLight(const std::string& text) {
    if (countNumbers(text) == 3) return {parsePoint(text, "--light"), std::nullopt};
    const std::vector<double> v = parseNumbers(text, 6, "--light");
    return {{v[0], v[1], v[2]}, toColor(v[3], v[4], v[5], "--light")};
}

void addPictureOptions(CLI::App& app, TraceOptions& options, OptionTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--size", texts.size, "Width and height in pixels")
            ->type_name("WxH")
            ->capture_default_str(),
        app.add_option("--eye", texts.eye, "Where the camera stands; else where it sees the whole scene")
            ->type_name("X,Y,Z"),
        app.add_option("--look-at", texts.lookAt, "What it looks at; else the scene's centre")
            ->type_name("X,Y,Z"),
        app.add_option("--up", texts.up, "Up in the picture; else +y, or +z for a view along y")
            ->type_name("X,Y,Z"),
        app.add_option("--fov", options.camera.fovDegrees, "Vertical field of view")
            ->type_name("DEG")
            ->capture_default_str(),
        app.add_option(
               "--light", texts.lights,
               "A point light instead of the scene's, repeatable; without R,G,B it gives a white surface "
               "at the scene's centre a radiance of 0.9")
            ->type_name("X,Y,Z[,R,G,B]"),
        app.add_option("--ambient", texts.ambient, "Light from everywhere")
            ->type_name("G|R,G,B")
            ->capture_default_str(),
        app.add_option("--background", texts.background, "Radiance behind the scene")
            ->type_name("G|R,G,B")
            ->capture_default_str(),
        app.add_option("--max-depth", options.maxDepth, "Reflections and refractions in a row")
            ->check(numberBetween(0, 16))
            ->type_name("N")
            ->capture_default_str(),
        app.add_flag("--reproducible", options.reproducible, "Leave times out of the picture's attributes"),
    };
    for (CLI::Option* option : added) option->group(kPictureGroup);
}

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
        app.add_option("--repeat", options.repeat, "Warm up, trace the rays N times and report the median")
            ->check(numberBetween(1, 100000))
            ->type_name("N"),
    };
    for (CLI::Option* option : added) option->group(kQueryGroup);
}

// Options of pictures and of ray queries do not mix.
void checkGroups(const CLI::App& app, const TraceOptions& options) {
    const bool query = !options.raysPath.empty();
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && option->get_group() == (query ? kPictureGroup : kQueryGroup))
            throw Error(ErrorKind::Usage, fmt::format("{} {} --rays", option->get_name(),
                                                      query ? "does not go with" : "needs"));
}

void convertTexts(const OptionTexts& texts, TraceOptions& options) {
    const std::vector<unsigned> size = parseSizes(texts.size, 2, "--size");
    options.size = {size[0], size[1]};
    if (!texts.eye.empty()) options.camera.eye = parsePoint(texts.eye, "--eye");
    if (!texts.lookAt.empty()) options.camera.lookAt = parsePoint(texts.lookAt, "--look-at");
    if (!texts.up.empty()) options.camera.up = parsePoint(texts.up, "--up");
    options.ambient = parseColor(texts.ambient, "--ambient");
    options.background = parseColor(texts.background, "--background");
    options.doublePrecision = texts.precision == "double";
    options.intersect = static_cast<unsigned>(
        std::find(kIntersectNames.begin(), kIntersectNames.end(), texts.intersect) - kIntersectNames.begin());
    if (texts.rayOrder == "coherent") options.rayOrder = RayOrder::Coherent;
    if (texts.rayOrder == "scattered") options.rayOrder = RayOrder::Scattered;
    for (const std::string& light : texts.lights) options.lights.push_back(parseLight(light));
}

void checkDevice(const std::string& device) {
    const bool index = !device.empty() && device.size() <= 4 &&
                       std::all_of(device.begin(), device.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!index && device != "auto" && device != "software")
        throw Error(
            ErrorKind::Usage,
            fmt::format("--device: '{}' is neither auto, software nor an index of --list-devices", device));
}

void checkPaths(const TraceOptions& options) {
    if (options.scenePath.empty()) throw Error(ErrorKind::Usage, "no scene was named; see rt-trace --help");
    if (options.outputPaths.empty()) throw Error(ErrorKind::Usage, "no output was named; add -o FILE");
    requireDistinctPaths({options.scenePath, options.raysPath}, outputsOf(options));
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

} // namespace

std::vector<std::string> outputsOf(const TraceOptions& options) {
    std::vector<std::string> paths = options.outputPaths;
    if (!options.common.jsonPath.empty()) paths.push_back(options.common.jsonPath);
    return paths;
}

std::optional<TraceOptions> parseTraceOptions(int argc, const char* const* argv) {
    CLI::App app("Traces pictures or rays through an atlas, on a GPU or on Mesa's software renderer.",
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
        ->take_all();
    addPictureOptions(app, options, texts);
    addQueryOptions(app, options, texts);
    app.add_option("--device", options.device,
                   "auto (hardware first), software, or an index of --list-devices")
        ->type_name("auto|software|N")
        ->capture_default_str();
    app.add_flag("--list-devices", options.listDevices, "Print the devices and which of them can be used");
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
    app.add_flag("--stats", options.stats, "Count rays, steps and triangle tests in a second pass");
    addCommonOptions(app, options.common,
                     fmt::format("libepoxy {}, OpenEXR {}", RT_EPOXY_VERSION, RT_OPENEXR_VERSION));
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    if (options.listDevices) return options;
    checkGroups(app, options);
    checkDevice(options.device);
    checkPaths(options);
    convertTexts(texts, options);
    return options;
}

} // namespace rt
