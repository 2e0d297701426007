#include "tools/rt-trace/picture_options.h"

#include "common/error.h"
#include "tools/rt-trace/environment.h"
#include "tools/rt-trace/parse_color.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rt {
namespace {

constexpr const char* kCameraGroup = "Pictures: camera";
constexpr const char* kLightGroup = "Pictures: light";
constexpr const char* kSampleGroup = "Pictures: samples";
constexpr const char* kOutputGroup = "Pictures: what is written";
constexpr unsigned kMostSamples = 1u << 24; // sums of floats end there
constexpr unsigned kOpenSamples = 4096;     // where something else ends the picture

// In the order of their constants.
constexpr std::array<const char*, 4> kFilterNames = {"box", "tent", "gaussian", "blackman-harris"};
constexpr std::array<double, 4> kFilterRadii = {0.5, 1.0, 1.5, 2.0};
constexpr std::array<const char*, 4> kToneMapNames = {"none", "reinhard", "aces", "filmic"};

struct AovName {
    const char* name;
    unsigned bit;
};
constexpr AovName kAovNames[] = {
    {"Z", kAovDepth},       {"N", kAovNormal},    {"P", kAovPosition},
    {"albedo", kAovAlbedo}, {"id", kAovId},       {"uv", kAovTexcoord},
    {"steps", kAovSteps},   {"tests", kAovTests}, {"variance", kAovVariance},
};

[[noreturn]] void throwUsage(const std::string& message) {
    throw Error(ErrorKind::Usage, message);
}

template <class Names>
unsigned indexIn(const Names& names, const std::string& name) {
    return static_cast<unsigned>(std::find(names.begin(), names.end(), name) - names.begin());
}

glm::dvec3 parsePoint(const std::string& text, const char* option) {
    const std::vector<double> v = parseNumbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

LightRequest parseLight(const std::string& text) {
    if (countNumbers(text) == 3) return {parsePoint(text, "--light"), std::nullopt};
    const std::vector<double> v = parseNumbers(text, 6, "--light");
    return {{v[0], v[1], v[2]}, toColor(v[3], v[4], v[5], "--light")};
}

glm::uvec4 parseCrop(const std::string& text, const glm::uvec2& size) {
    const std::vector<double> v = parseNumbers(text, 4, "--crop");
    const bool whole =
        std::all_of(v.begin(), v.end(), [](double x) { return x >= 0.0 && x == std::floor(x); });
    if (!whole || !(v[0] < v[2] && v[2] <= size.x && v[1] < v[3] && v[3] <= size.y))
        throwUsage(fmt::format("--crop: '{}' is no part of {}x{} pixels: x0,y0 is its first pixel, x1,y1 the "
                               "first one behind it",
                               text, size.x, size.y));
    return {v[0], v[1], v[2], v[3]};
}

unsigned parseAovs(const std::string& text) {
    if (text == "all") return kAllAovs;
    if (text == "none") return 0;
    unsigned aovs = 0;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string name = text.substr(begin, end - begin);
        const auto known = std::find_if(std::begin(kAovNames), std::end(kAovNames),
                                        [&](const AovName& aov) { return name == aov.name; });
        if (known == std::end(kAovNames))
            throwUsage(fmt::format("--aov: '{}' is none of Z, N, P, albedo, id, uv, steps, tests, variance, "
                                   "all, none",
                                   name));
        aovs |= known->bit;
        begin = end + 1;
    }
    return aovs;
}

FrameRange parseFrames(const std::string& text) {
    FrameRange frames;
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, frames.first);
    frames.last = frames.first;
    bool good = first.ec == std::errc();
    const char* at = first.ptr;
    if (good && at != end && *at == '-') {
        const auto last = std::from_chars(at + 1, end, frames.last);
        good = last.ec == std::errc();
        at = last.ptr;
    }
    if (!good || at != end || frames.last < frames.first)
        throwUsage(fmt::format("--frames: '{}' is not a range such as 1-48", text));
    return frames;
}

// What --help shows of them stands in the type's name.
CLI::Validator oneOf(std::vector<std::string> names) {
    return CLI::IsMember(std::move(names)).description("");
}
CLI::Validator notNegative() {
    return {[](const std::string& text) -> std::string {
                double value = 0.0;
                const bool isNumber = CLI::detail::lexical_cast(text, value);
                return isNumber && value >= 0.0 ? "" : text + " is not a number of 0 or more";
            },
            ""};
}
CLI::Validator positive() {
    return {[](const std::string& text) -> std::string {
                double value = 0.0;
                const bool isNumber = CLI::detail::lexical_cast(text, value);
                return isNumber && value > 0.0 ? "" : text + " is not a number above 0";
            },
            ""};
}

template <class Names>
std::vector<std::string> listOf(const Names& names) {
    return {names.begin(), names.end()};
}

void addCameraOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    CameraRequest& camera = options.camera;
    const std::vector<CLI::Option*> added = {
        app.add_option("--camera", camera.name,
                       "A camera of the scene, see --list-cameras; the options below "
                       "change what they say")
            ->type_name("NAME"),
        app.add_option("--eye", texts.eye, "Where the camera stands; else where it sees the whole scene")
            ->type_name("X,Y,Z"),
        app.add_option("--look-at", texts.lookAt, "What it looks at; else the scene's centre")
            ->type_name("X,Y,Z"),
        app.add_option("--up", texts.up, "Up in the picture; else +y, or +z for a view along y")
            ->type_name("X,Y,Z"),
        app.add_option("--fov", camera.fovDegrees, "Vertical field of view")
            ->type_name("DEG")
            ->default_str(fmt::format("{}", kDefaultFovDegrees)),
        app.add_option(
               "--projection", texts.view,
               "perspective; orthographic: no foreshortening; panorama: all around, 360 by 180 degrees")
            ->check(oneOf({"perspective", "orthographic", "panorama"}))
            ->type_name("perspective|orthographic|panorama"),
        app.add_option("--height", camera.height,
                       "Orthographic: height of what the picture shows; else that of the scene")
            ->type_name("H"),
        app.add_option(
               "--lens-radius", camera.lensRadius,
               "Radius of the lens, in the scene's units: what is out of focus blurs; 0 = all is sharp")
            ->type_name("R"),
        app.add_option("--focus", camera.focusDistance,
                       "Distance from the camera of what is in focus; else that of --look-at")
            ->type_name("DIST"),
        app.add_option("--camera-path", options.cameraPath,
                       "Cameras for --frames: a JSON array of {frame, eye, lookAt, up, fov}, with straight "
                       "lines between its frames; else the path of the scene's --camera")
            ->type_name("FILE"),
    };
    for (CLI::Option* option : added) option->group(kCameraGroup);
}

void addLightOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option(
               "--light", texts.lights,
               "A point light instead of the scene's, repeatable; without R,G,B it gives a white surface "
               "at the scene's centre a radiance of 0.9")
            ->type_name("X,Y,Z[,R,G,B]"),
        app.add_option("--ambient", texts.ambient,
                       "Light from everywhere; else 0.1, or none with an environment")
            ->type_name("G|R,G,B"),
        app.add_option("--occlusion", options.occlusion,
                       "Surfaces nearer than this hide ambient light; 0 = none does")
            ->check(notNegative())
            ->type_name("DIST")
            ->capture_default_str(),
        app.add_option("--background", texts.background,
                       "Radiance behind the scene; else the scene's, or 0.32,0.4,0.5")
            ->type_name("G|R,G,B"),
        app.add_option("--environment", options.environment,
                       "Light from far away on all sides, and what is seen there: a picture of 360 by 180 "
                       "degrees, .exr or .hdr, or one colour; else the scene's, if it has one")
            ->type_name("FILE|G|R,G,B"),
        app.add_option("--environment-turn", options.environmentTurn,
                       "Turns it about the scene's +y; else as the scene says of its own, or 0")
            ->type_name("DEG"),
        app.add_option("--environment-strength", options.environmentStrength,
                       "Makes it brighter or darker; else as the scene says of its own, or 1")
            ->check(notNegative())
            ->type_name("X"),
        app.add_option("--max-depth", options.maxDepth, "Reflections and refractions in a row")
            ->check(numberBetween(0, 16))
            ->type_name("N")
            ->capture_default_str(),
    };
    for (CLI::Option* option : added) option->group(kLightGroup);
}

void addSampleOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--spp", texts.samples,
                       fmt::format("Samples per pixel, {} at most with --time-limit or --target-error unless "
                                   "this says otherwise",
                                   kOpenSamples))
            ->check(numberBetween(1u, kMostSamples))
            ->type_name("N")
            ->default_str("1"),
        app.add_option("--seed", options.seed, "Other numbers give other noise")
            ->type_name("N")
            ->capture_default_str(),
        app.add_option("--filter", texts.filter, "How samples round a pixel's middle count")
            ->check(oneOf(listOf(kFilterNames)))
            ->type_name(fmt::format("{}", fmt::join(kFilterNames, "|")))
            ->capture_default_str(),
        app.add_option("--filter-radius", texts.filterRadius,
                       "How far from the middle; else box 0.5, tent 1, gaussian 1.5, blackman-harris 2")
            ->check(numberBetween(0.01, 16.0))
            ->type_name("PX"),
        app.add_option(
               "--time-limit", options.timeLimitSeconds,
               "Take no more samples after so many seconds of rendering; each pixel gets one at least")
            ->check(positive())
            ->type_name("SEC"),
        app.add_option("--target-error", options.targetError,
                       "Take no more samples in a tile of 32x32 pixels whose relative standard error is "
                       "this small, 0.02 say")
            ->check(positive())
            ->type_name("X"),
        app.add_option("--checkpoint", options.checkpointPath,
                       "Save the unfinished picture every 30 seconds and when the run is interrupted")
            ->type_name("FILE"),
        app.add_option("--resume", options.resumePath, "Go on from a checkpoint of the same picture")
            ->type_name("FILE"),
    };
    for (CLI::Option* option : added) option->group(kSampleGroup);
}

void addOutputOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option(
               "--aov", texts.aovs,
               "What an EXR holds beside the colours: Z, N, P, albedo, id, uv, steps, tests, variance; "
               "or all, or none")
            ->type_name("LIST")
            ->capture_default_str(),
        app.add_option("--tonemap", texts.toneMap, "How bright colours fit into a PNG; an EXR stays linear")
            ->check(oneOf(listOf(kToneMapNames)))
            ->type_name(fmt::format("{}", fmt::join(kToneMapNames, "|")))
            ->capture_default_str(),
        app.add_option("--exposure", options.exposureStops, "Brightens a PNG by 2^STOPS")
            ->check(numberBetween(-100.0, 100.0))
            ->type_name("STOPS")
            ->capture_default_str(),
        app.add_option("--heat", texts.heat,
                       "Instead of the scene show what it costs: steps or triangle tests per pixel")
            ->check(oneOf({"steps", "tests"}))
            ->type_name("steps|tests"),
        app.add_option("--heat-max", options.heatMost, "What --heat shows in yellow; else the picture's most")
            ->check(positive())
            ->type_name("N"),
        app.add_option("--frames", texts.frames,
                       "A picture for each of these frames of --camera-path, or of the path that the scene's "
                       "--camera has; outputs have %d or %04d in their name")
            ->type_name("A-B"),
        app.add_flag("--reproducible", options.reproducible, "Leave times out of the picture's attributes"),
    };
    for (CLI::Option* option : added) option->group(kOutputGroup);
}

void convertSamples(const PictureTexts& texts, TraceOptions& options) {
    const bool open = options.timeLimitSeconds > 0.0 || options.targetError > 0.0;
    options.samples = texts.samples.value_or(open ? kOpenSamples : 1);
    options.filter = indexIn(kFilterNames, texts.filter);
    options.filterRadius = texts.filterRadius.value_or(kFilterRadii[options.filter]);
    options.aovs = parseAovs(texts.aovs);
    if (options.samples > 1) return;
    if ((options.aovs & kAovVariance) && texts.aovs != "all")
        throwUsage("--aov variance needs more samples than one; add --spp N");
    options.aovs &= ~kAovVariance;
}

void checkFrames(const TraceOptions& options) {
    const CameraRequest& camera = options.camera;
    const bool hasPath = !options.cameraPath.empty();
    if (hasPath && (!options.frames || !camera.name.empty()))
        throwUsage(options.frames ? "--camera and --camera-path do not go together: each is a path"
                                  : "--frames and --camera-path go together");
    if (!options.frames) return;
    if (!hasPath && camera.name.empty())
        throwUsage("--frames needs --camera-path, or --camera and a scene in which that camera has a path");
    if (camera.eye || camera.lookAt || camera.up || camera.fovDegrees)
        throwUsage("--eye, --look-at, --up and --fov do not go with --frames: the camera's path says that");
    if (!options.checkpointPath.empty() || !options.resumePath.empty())
        throwUsage("--checkpoint and --resume are for single pictures; they do not go with --frames");
    for (const std::string& path : options.outputPaths)
        if (!framePath(path, 0))
            throwUsage(
                fmt::format("-o {}: with --frames a name needs a %d or %04d where the number goes", path));
}

} // namespace

void addPictureOptions(CLI::App& app, TraceOptions& options, PictureTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--size", texts.size, "Width and height in pixels")
            ->type_name("WxH")
            ->capture_default_str(),
        app.add_option("--crop", texts.crop,
                       "Only these pixels of it; an EXR still knows the whole size, a PNG is smaller")
            ->type_name("x0,y0,x1,y1"),
    };
    for (CLI::Option* option : added) option->group(kPictureGroup);
    addCameraOptions(app, options, texts);
    addLightOptions(app, options, texts);
    addSampleOptions(app, options, texts);
    addOutputOptions(app, options, texts);
}

void convertPictureTexts(const PictureTexts& texts, TraceOptions& options) {
    const std::vector<unsigned> size = parseSizes(texts.size, 2, "--size");
    options.size = {size[0], size[1]};
    options.window =
        texts.crop.empty() ? glm::uvec4(0, 0, options.size) : parseCrop(texts.crop, options.size);
    CameraRequest& camera = options.camera;
    if (!texts.eye.empty()) camera.eye = parsePoint(texts.eye, "--eye");
    if (!texts.lookAt.empty()) camera.lookAt = parsePoint(texts.lookAt, "--look-at");
    if (!texts.up.empty()) camera.up = parsePoint(texts.up, "--up");
    for (const unsigned view : {kPerspectiveView, kOrthographicView, kPanoramaView})
        if (texts.view == viewName(view)) camera.view = view;
    if (!texts.ambient.empty()) options.ambient = parseColor(texts.ambient, "--ambient");
    if (!texts.background.empty()) options.background = parseColor(texts.background, "--background");
    if (!options.environment.empty()) checkEnvironment(options.environment);
    for (const std::string& light : texts.lights) options.lights.push_back(parseLight(light));
    convertSamples(texts, options);
    options.toneMap = static_cast<ToneMap>(indexIn(kToneMapNames, texts.toneMap));
    if (!texts.heat.empty()) options.heat = texts.heat == "steps" ? Heat::Steps : Heat::Tests;
    for (const double number :
         {options.environmentTurn.value_or(0.0), options.environmentStrength.value_or(1.0),
          options.exposureStops, options.occlusion, options.timeLimitSeconds, options.targetError})
        if (!std::isfinite(number)) throwUsage("'nan' and 'inf' are no numbers for an option");
    if (options.heatMost > 0.0 && options.heat == Heat::None) throwUsage("--heat-max needs --heat");
    if (!texts.frames.empty()) options.frames = parseFrames(texts.frames);
    checkFrames(options);
}

std::optional<std::string> framePath(const std::string& path, unsigned frame) {
    const std::size_t at = path.find('%');
    if (at == std::string::npos || path.find('%', at + 1) != std::string::npos) return std::nullopt;
    std::size_t end = at + 1;
    unsigned digits = 0;
    const bool padded = end < path.size() && path[end] == '0';
    for (; end < path.size() && path[end] >= '0' && path[end] <= '9' && end < at + 4; ++end)
        digits = digits * 10 + static_cast<unsigned>(path[end] - '0');
    if (end >= path.size() || path[end] != 'd' || (digits > 0 && !padded)) return std::nullopt;
    return path.substr(0, at) + fmt::format("{:0{}}", frame, std::max(digits, 1u)) + path.substr(end + 1);
}

} // namespace rt
