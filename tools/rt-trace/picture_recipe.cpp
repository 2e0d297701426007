#include "tools/rt-trace/picture_recipe.h"

#include "formats/environment_picture.h"

#include <fmt/format.h>

#include <map>

namespace rt {

std::vector<RecipeInput> inputsOf(const TraceOptions& options) {
    std::vector<RecipeInput> inputs{{"scene", options.scenePath}};
    if (!options.raysPath.empty()) inputs.push_back({"--rays", options.raysPath});
    if (!options.cameraPath.empty()) inputs.push_back({"--camera-path", options.cameraPath});
    if (isEnvironmentFile(options.environment)) inputs.push_back({"--environment", options.environment});
    return inputs;
}

std::string makingOf(const CLI::App& app, const TraceOptions& options, bool wholePicture) {
    std::vector<std::string> neutral{"scene",     "--rays",           "--camera-path", "--device",
                                     "--resume",  "--checkpoint",     "--frames",      "--max-gpu-memory",
                                     "--explain", "--no-shader-cache"};
    if (isEnvironmentFile(options.environment)) neutral.push_back("--environment");
    if (wholePicture) neutral.insert(neutral.end(), {"--shard", "--shard-by"});
    return makingOf(app, options.common, neutral) + (options.device == "software" ? "\nsoftware" : "");
}

Recipe recipeOfFrame(const Recipe& recipe, unsigned frame) {
    return recipe.isKnown() ? Recipe(fmt::format("{}\nframe {}", recipe.text(), frame)) : Recipe();
}

Recipe recipeOfReport(const TraceOptions& options) {
    if (!options.frames || !options.recipe.isKnown()) return options.recipe;
    return Recipe(
        fmt::format("{}\nframes {}-{}", options.recipe.text(), options.frames->first, options.frames->last));
}

bool isUpToDate(const TraceOptions& options) {
    std::vector<std::string> outputs;
    std::map<std::string, Recipe> recipes;
    const auto add = [&](const std::string& path, Recipe recipe) {
        outputs.push_back(path);
        recipes[path] = std::move(recipe);
    };
    for (const std::string& path : options.outputPaths) {
        if (!options.frames) add(path, options.recipe);
        const FrameRange frames = options.frames.value_or(FrameRange{1, 0});
        for (std::uint64_t frame = frames.first; frame <= frames.last; ++frame)
            add(framePath(path, static_cast<unsigned>(frame)).value_or(path),
                recipeOfFrame(options.recipe, static_cast<unsigned>(frame)));
    }
    if (!options.common.jsonPath.empty()) add(options.common.jsonPath, recipeOfReport(options));
    const auto isMade = [&](const std::string& output) { return carries(output, recipes.at(output)); };
    return isUpToDate(options.common, outputs, isMade);
}

} // namespace rt
