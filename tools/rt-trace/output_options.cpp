#include "common/command_line.h"
#include "common/error.h"
#include "tools/rt-trace/option_groups.h"
#include "tools/rt-trace/option_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace rt {
namespace {

constexpr std::array<const char*, 3> kHeatNames = {"steps", "tests", "time"}; // from Heat::Steps on

constexpr unsigned kMostSide = 1u << 20; // floats tell the places within a pixel apart up to there

struct AovName {
    const char* name;
    unsigned bit;
};
constexpr AovName kAovNames[] = {
    {"Z", kAovDepth},           {"N", kAovNormal},    {"P", kAovPosition},
    {"albedo", kAovAlbedo},     {"id", kAovId},       {"uv", kAovTexcoord},
    {"steps", kAovSteps},       {"tests", kAovTests}, {"variance", kAovVariance},
    {"material", kAovMaterial}, {"time", kAovTime},
};

[[noreturn]] void throwUsage(const std::string& message) {
    throw Error(ErrorKind::Usage, message);
}

glm::uvec2 parseSize(const std::string& text) {
    const std::vector<unsigned> size = parseSizes(text, 2, "--size");
    if (std::max(size[0], size[1]) > kMostSide)
        throwUsage(fmt::format("--size: {}x{} is more than {} on a side", size[0], size[1], kMostSide));
    return {size[0], size[1]};
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
    if (text == "none") return 0;
    unsigned aovs = 0;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string name = text.substr(begin, end - begin);
        const auto known = std::find_if(std::begin(kAovNames), std::end(kAovNames),
                                        [&](const AovName& aov) { return name == aov.name; });
        if (known == std::end(kAovNames) && name != "all")
            throwUsage(fmt::format("--aov: '{}' is none of Z, N, P, albedo, id, material, uv, steps, tests, "
                                   "time, variance, all; or none alone",
                                   name));
        aovs |= name == "all" ? kAllAovs : known->bit;
        begin = end + 1;
    }
    return aovs;
}

} // namespace

void addOutputOptions(CLI::App& app, TraceOptions& options, OutputTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--size", texts.size, "Width and height in pixels")
            ->type_name("WxH")
            ->capture_default_str(),
        app.add_option("--crop", texts.crop,
                       "Only these pixels of it; an EXR still knows the whole size, a PNG is smaller")
            ->type_name("x0,y0,x1,y1"),
        app.add_option(
               "--aov", texts.aovs,
               "What an EXR holds beside the colours: Z, N, P, albedo, id, material, uv, steps, tests, time, "
               "variance; or all (but time, which differs from run to run), or none")
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
                       "Instead of the scene show what it costs: steps, triangle tests or ticks of the "
                       "device's clock "
                       "per pixel")
            ->check(oneOf(listOf(kHeatNames)))
            ->type_name(fmt::format("{}", fmt::join(kHeatNames, "|"))),
        app.add_option("--heat-max", options.heatMost,
                       "What --heat shows in yellow; else the picture's most, of times what 99 % of its "
                       "pixels take at most")
            ->check(positive())
            ->type_name("N"),
        app.add_option("--frames", texts.frames,
                       "A picture for each of these frames of --turntable, --camera-path, or the path that "
                       "the scene's "
                       "--camera "
                       "has; if there are several, outputs have %d or %04d in their name")
            ->type_name("A-B"),
        app.add_flag("--reproducible", options.reproducible, "Leave times out of the picture's attributes"),
    };
    for (CLI::Option* option : added) option->group("Pictures: what is written");
}

void convertOutput(const OutputTexts& texts, TraceOptions& options) {
    options.size = parseSize(texts.size);
    options.window =
        texts.crop.empty() ? glm::uvec4(0, 0, options.size) : parseCrop(texts.crop, options.size);
    options.aovs = parseAovs(texts.aovs);
    if (options.samples == 1) {
        if ((options.aovs & kAovVariance) && texts.aovs.find("variance") != std::string::npos)
            throwUsage("--aov variance needs more samples than one; add --spp N");
        options.aovs &= ~kAovVariance;
    }
    options.toneMap = static_cast<ToneMap>(indexIn(kToneMapNames, texts.toneMap));
    if (!texts.heat.empty()) options.heat = static_cast<Heat>(1 + indexIn(kHeatNames, texts.heat));
    if (!texts.frames.empty()) options.frames = parseFrames(texts.frames);
}

} // namespace rt
