#include "common/error.h"
#include "formats/image.h"
#include "tools/rt-trace/option_groups.h"
#include "tools/rt-trace/option_values.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rt {
namespace {

[[noreturn]] void throwUsage(const std::string& message) {
    throw Error(ErrorKind::Usage, message);
}

Shard parseShard(const std::string& text) {
    Shard shard;
    const char* const end = text.data() + text.size();
    const auto index = std::from_chars(text.data(), end, shard.index);
    const bool cut = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
    const auto count = std::from_chars(cut ? index.ptr + 1 : end, end, shard.count);
    if (!cut || count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.index > shard.count)
        throwUsage(fmt::format("--shard: '{}' is no shard such as 1/4: the first to the last of 4 are 1/4 to "
                               "4/4",
                               text));
    return shard;
}

void requireEnough(const Shard& shard, const TraceOptions& options) {
    const unsigned most = mostShards(shard.kind, options.window, options.samples);
    if (shard.count <= most) return;
    const std::string asked = fmt::format("--shard {}/{}: ", shard.index, shard.count);
    if (shard.kind == ShardKind::Samples)
        throwUsage(fmt::format("{}{} samples per pixel make no more than {} shards; raise --spp or lower the "
                               "number of shards",
                               asked, options.samples, most));
    throwUsage(fmt::format("{}{} rows of pixels make no more than {} shards, each of which has whole rows of "
                           "tiles of 32x32 pixels; lower the number of shards or take --shard-by samples",
                           asked, options.window.w - options.window.y, most));
}

// What a run would decide by what it sees of the picture, others might decide otherwise.
void requireSharable(const Shard& shard, const TraceOptions& options) {
    const bool bySamples = shard.kind == ShardKind::Samples;
    if (bySamples && (options.timeLimitSeconds > 0.0 || options.targetError > 0.0))
        throwUsage(
            fmt::format("--shard-by samples does not go with {}: each shard takes the samples that are its "
                        "own; take --shard-by parts",
                        options.targetError > 0.0 ? "--target-error" : "--time-limit"));
    if (bySamples && options.heat != Heat::None)
        throwUsage("--shard-by samples does not go with --heat, whose colours cannot be averaged; take "
                   "--shard-by parts, or --aov steps,tests");
    if (options.heat != Heat::None && options.heatMost == 0.0)
        throwUsage("--shard with --heat needs --heat-max, or each shard has a yellow of its own");
    const auto isExr = [](const std::string& path) { return imageFileType(path) == ImageFileType::Exr; };
    if (!options.outputPaths.empty() &&
        std::none_of(options.outputPaths.begin(), options.outputPaths.end(), isExr))
        throwUsage("--shard needs an .exr among the outputs: only those can be merged");
}

} // namespace

void addShardOptions(CLI::App& app, ShardTexts& texts) {
    const std::vector<CLI::Option*> added = {
        app.add_option("--shard", texts.shard,
                       "Only the i-th of n shards, i from 1 on, which rt-trace merge puts together")
            ->type_name("i/n"),
        app.add_option("--shard-by", texts.kind,
                       "What a shard has: rows of the picture, or some of each pixel's samples")
            ->check(oneOf(listOf(kShardKindNames)))
            ->type_name(fmt::format("{}", fmt::join(kShardKindNames, "|")))
            ->capture_default_str(),
    };
    for (CLI::Option* option : added) option->group("Pictures: shards");
}

void convertShard(const ShardTexts& texts, TraceOptions& options) {
    options.wholeWindow = options.window;
    options.range = {0, options.samples};
    if (texts.shard.empty()) return;
    Shard shard = parseShard(texts.shard);
    shard.kind = static_cast<ShardKind>(indexIn(kShardKindNames, texts.kind));
    requireSharable(shard, options);
    requireEnough(shard, options);
    options.shard = shard;
    options.window = windowOf(shard, options.wholeWindow);
    options.range = samplesOf(shard, options.samples);
}

} // namespace rt
