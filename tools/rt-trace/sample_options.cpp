#include "common/command_line.h"
#include "tools/rt-trace/option_groups.h"
#include "tools/rt-trace/option_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>

namespace rt {
namespace {

constexpr unsigned kMostSamples = 1u << 24; // sums of floats end there
constexpr unsigned kOpenSamples = 4096;     // where something else ends the picture

// In the order of their constants.
constexpr std::array<const char*, 4> kFilterNames = {"box", "tent", "gaussian", "blackman-harris"};
constexpr std::array<double, 4> kFilterRadii = {0.5, 1.0, 1.5, 2.0};

} // namespace

void addSampleOptions(CLI::App& app, TraceOptions& options, SampleTexts& texts) {
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
    for (CLI::Option* option : added) option->group("Pictures: samples");
}

void convertSamples(const SampleTexts& texts, TraceOptions& options) {
    const bool open = options.timeLimitSeconds > 0.0 || options.targetError > 0.0;
    options.samples = texts.samples.value_or(open ? kOpenSamples : 1);
    options.filter = indexIn(kFilterNames, texts.filter);
    options.filterRadius = texts.filterRadius.value_or(kFilterRadii[options.filter]);
}

} // namespace rt
