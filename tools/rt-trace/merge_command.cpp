#include "tools/rt-trace/merge_command.h"

#include "common/binary_io.h"
#include "common/command_line.h"
#include "common/error.h"
#include "common/log.h"
#include "common/progress.h"
#include "common/stage_timer.h"
#include "formats/image_attributes.h"
#include "formats/image_exr.h"
#include "formats/recipe.h"
#include "tools/rt-trace/merge_shards.h"
#include "tools/rt-trace/option_values.h"
#include "tools/rt-trace/picture_files.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace rt {
namespace {

const char* const kDescription = "Puts the shards of a picture together, which rt-trace --shard has "
                                 "rendered. All of them have to be there, in any\n"
                                 "order. Shards of rows give the picture as one run would have, to the bit; "
                                 "shards of samples do within rounding.\n"
                                 "Needs no GPU.";

struct MergeOptions {
    std::vector<std::string> shardPaths;
    std::vector<std::string> outputPaths;
    ToneMap toneMap = ToneMap::None;
    double exposureStops = 0.0;
    MemoryLimit memory = defaultMemoryLimit();
    CommonOptions common;
};

bool isPng(const std::string& path) {
    return imageFileType(path) == ImageFileType::Png;
}

std::vector<std::string> outputsOf(const MergeOptions& options) {
    std::vector<std::string> outputs = options.outputPaths;
    for (const std::string& path : {options.common.jsonPath, options.common.depfilePath})
        if (!path.empty()) outputs.push_back(path);
    return outputs;
}

void check(const CLI::App& app, const MergeOptions& options) {
    for (const std::string& path : options.outputPaths)
        if (!imageFileType(path))
            throw Error(ErrorKind::Usage, fmt::format("-o {}: pictures end in .exr or .png", path));
    const bool png = std::any_of(options.outputPaths.begin(), options.outputPaths.end(), isPng);
    for (const char* const option : {"--tonemap", "--exposure"})
        if (!png && app.get_option(option)->count() > 0)
            throw Error(ErrorKind::Usage, fmt::format("{} needs a .png among the outputs", option));
    requireDistinctPaths(options.shardPaths, outputsOf(options));
    checkBuildOptions(options.common, options.shardPaths, outputsOf(options));
}

std::optional<MergeOptions> parse(int argc, const char* const* argv) {
    MergeOptions options;
    std::string toneMap = kToneMapNames[0], maxMemory;
    CLI::App app(kDescription, "rt-trace merge");
    app.add_option("shards", options.shardPaths, "Inputs: every shard of the picture")
        ->required()
        ->type_name("part.exr...");
    app.add_option("-o,--output", options.outputPaths, "The picture, .exr or .png; repeatable")
        ->required()
        ->type_name("FILE")
        ->expected(1)
        ->allow_extra_args(false) // what follows is an input, not another name
        ->take_all();
    app.add_option("--tonemap", toneMap, "How bright colours fit into a PNG; an EXR stays linear")
        ->check(oneOf(listOf(kToneMapNames)))
        ->type_name(fmt::format("{}", fmt::join(kToneMapNames, "|")))
        ->capture_default_str();
    app.add_option("--exposure", options.exposureStops, "Brightens a PNG by 2^STOPS")
        ->check(numberBetween(-100.0, 100.0))
        ->type_name("STOPS")
        ->capture_default_str();
    app.add_option("--max-memory", maxMemory,
                   fmt::format("Most that the picture may take, {} unless this says otherwise",
                               options.memory.origin))
        ->type_name("SIZE[K|M|G]");
    addCommonOptions(app, options.common, fmt::format("OpenEXR {}", RT_OPENEXR_VERSION));
    addBuildOptions(app, options.common);
    if (!parseCommandLine(app, argc, argv, options.common)) return std::nullopt;
    if (!maxMemory.empty()) options.memory = {parseByteSize(maxMemory, "--max-memory"), "--max-memory"};
    options.toneMap = static_cast<ToneMap>(indexIn(kToneMapNames, toneMap));
    check(app, options);
    options.common.making = makingOf(app, options.common, {"shards", "--max-memory"});
    return options;
}

/// What outputs carry.
struct MergeRecipes {
    Recipe merge; ///< of these shards and options
    Recipe exr;   ///< that of the picture rendered in one run, if its bits are the same

    const Recipe& of(const std::string& path) const {
        return imageFileType(path) == ImageFileType::Exr ? exr : merge;
    }
};

// Of what was opened: a shard may be replaced by another meanwhile.
MergeRecipes recipesOf(const MergeOptions& options, const std::vector<ShardFile>& files) {
    std::vector<RecipeInput> inputs;
    for (const ShardFile& file : files) inputs.push_back({"shard", contentIdOf(file.bytes)});
    MergeRecipes recipes{recipeOf(options.common.making, inputs), wholeRecipeOf(files)};
    if (!recipes.exr.isKnown()) recipes.exr = recipes.merge;
    return recipes;
}

/// The picture as the outputs are to have it, filled row by row.
class MergedPicture {
public:
    MergedPicture(const Image& header, const std::vector<std::string>& paths, const MergeRecipes& recipes)
        : recipes_(recipes) {
        if (!std::all_of(paths.begin(), paths.end(), isPng)) exr_.emplace(header);
        if (std::none_of(paths.begin(), paths.end(), isPng)) return;
        screen_.emplace().width = header.width;
        screen_->texts[kRecipeKey] = recipes.merge.mark();
        screen_->height = header.height;
        for (const ImageChannel& channel : header.channels)
            if (isColor(channel)) screen_->channels.push_back(channel);
    }

    void add(const Image& rows) {
        if (exr_) exr_->add(rows);
        if (!screen_) return;
        auto to = screen_->channels.begin();
        for (const ImageChannel& channel : rows.channels) {
            if (!isColor(channel)) continue;
            to->values.insert(to->values.end(), channel.values.begin(), channel.values.end());
            ++to;
        }
    }

    /// All of them or none.
    void write(const MergeOptions& options) {
        std::vector<std::byte> exr, png;
        if (exr_) exr = sealed(exr_->finish(), recipes_.exr);
        if (screen_)
            png = sealed(encodeImage("picture.png",
                                     forScreen(std::move(*screen_), options.toneMap, options.exposureStops)),
                         recipes_.merge);
        std::vector<OutputFile> files;
        for (const std::string& path : options.outputPaths)
            files.push_back({path, {isPng(path) ? png : exr}});
        writeFiles(files);
    }

    /// At most: how well pixels can be compressed is not known before.
    static std::uint64_t bytesFor(const Image& header, bool png) {
        std::uint64_t perPixel = 0;
        for (const ImageChannel& channel : header.channels)
            perPixel += channel.type == ImageChannel::Type::Half ? 2 : 4;
        constexpr std::uint64_t kScreenBytes = 2 * 3 * sizeof(float) + 3; // with a copy, and as 8 bits
        return header.pixelCount() * (perPixel + (png ? kScreenBytes : 0));
    }

private:
    static bool isColor(const ImageChannel& channel) {
        return channel.name == "R" || channel.name == "G" || channel.name == "B";
    }

    const MergeRecipes& recipes_;
    std::optional<ExrEncoder> exr_;
    std::optional<Image> screen_; // R, G, B
};

void requireMemory(const MergeOptions& options, const Image& header) {
    const bool png = std::any_of(options.outputPaths.begin(), options.outputPaths.end(), isPng);
    const std::uint64_t bytes = MergedPicture::bytesFor(header, png);
    if (bytes > options.memory.bytes)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: its picture of {}x{} pixels may take {} MiB; the limit is {} MiB ({}); "
                                "raise --max-memory",
                                options.shardPaths[0], header.width, header.height, bytes >> 20,
                                options.memory.bytes >> 20, options.memory.origin));
}

nlohmann::json reportOf(const std::vector<ShardFile>& files, const Image& header, const StageTimer& stages) {
    nlohmann::json report = {{"tool", "rt-trace merge"},
                             {"shards", files.size()},
                             {"shardBy", kShardKindNames[static_cast<std::size_t>(files[0].record.kind)]},
                             {"width", header.width},
                             {"height", header.height},
                             {kSamplesKey, header.ints.at(kSamplesKey)}};
    if (const auto seconds = header.floats.find(kRenderSecondsKey); seconds != header.floats.end())
        report[kRenderSecondsKey] = seconds->second;
    for (const auto& [stage, ms] : stages.stagesMs()) report[stage + "Ms"] = ms;
    report["peakMemoryBytes"] = peakMemoryBytes();
    return report;
}

void merge(const MergeOptions& options, const std::vector<ShardFile>& files, const MergeRecipes& recipes,
           StageTimer& stages) {
    Image header = mergedHeader(files);
    if (recipes.exr.isKnown()) header.texts[kRecipeKey] = recipes.exr.mark();
    requireMemory(options, header);
    stages.begin("merge");
    MergedPicture picture(header, options.outputPaths, recipes);
    {
        Progress progress("rows", header.height);
        double done = 0.0;
        mergeRows(files, [&](const Image& rows) {
            picture.add(rows);
            progress.update(done += rows.height);
        });
    }
    stages.begin("write");
    picture.write(options);
    stages.end();
    logInfo(fmt::format("{} shards make {}x{} pixels", files.size(), header.width, header.height));
    logStages(stages);
    if (!options.common.jsonPath.empty())
        writeReport(options.common.jsonPath, reportOf(files, header, stages), recipes.merge);
}

} // namespace

int mergeCommand(int argc, const char* const* argv) {
    const std::optional<MergeOptions> options = parse(argc, argv);
    if (!options) return 0;
    const std::vector<std::string> outputs = outputsOf(*options);
    for (const std::string& path : outputs) requireWritable(path);
    StageTimer stages;
    stages.begin("open");
    const std::vector<ShardFile> files = openShards(options->shardPaths);
    const MergeRecipes recipes = recipesOf(*options, files);
    const auto isMade = [&](const std::string& output) { return carries(output, recipes.of(output)); };
    if (!isUpToDate(options->common, outputs, isMade)) merge(*options, files, recipes, stages);
    writeDependencies(options->common, outputs, options->shardPaths);
    return 0;
}

} // namespace rt
