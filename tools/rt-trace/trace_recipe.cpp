#include "tools/rt-trace/trace_recipe.h"

#include "formats/environment_picture.h"
#include "formats/image_attributes.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <map>

namespace rt {
namespace {

bool arePicturesUpToDate(const TraceOptions& options, const TraceRecipes& recipes) {
    std::vector<std::string> outputs;
    std::map<std::string, Recipe> wanted;
    const auto add = [&](const std::string& path, const Recipe& recipe) {
        outputs.push_back(path);
        wanted[path] = recipe;
    };
    for (const std::string& path : options.outputPaths) {
        if (!options.frames) add(path, recipes.own);
        const FrameRange frames = options.frames.value_or(FrameRange{1, 0});
        for (std::uint64_t frame = frames.first; frame <= frames.last; ++frame) {
            const auto number = static_cast<unsigned>(frame);
            add(framePath(path, number).value_or(path), recipesOfFrame(recipes, number).own);
        }
    }
    if (!options.common.jsonPath.empty()) add(options.common.jsonPath, recipeOfReport(options, recipes.own));
    const auto isMade = [&](const std::string& output) { return carries(output, wanted.at(output)); };
    return isUpToDate(options.common, outputs, isMade);
}

bool areHitsUpToDate(const TraceOptions& options, const Recipe& recipe) {
    const std::string& report = options.common.jsonPath;
    const auto isMade = [&](const std::string& output) {
        if (output == report) return carries(report, recipe);
        const nlohmann::json json = nlohmann::json::parse(std::ifstream(report), nullptr, false);
        const std::optional<std::string> id = contentIdOf(output);
        return id && json.is_object() && json.value(kHitsIdKey, nlohmann::json()) == *id;
    };
    return isUpToDate(options.common, {report, options.outputPaths[0]}, isMade);
}

} // namespace

std::vector<InputFile> inputsOf(const TraceOptions& options) {
    std::vector<InputFile> inputs{{"scene", options.scenePath}};
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
    return makingOf(app, options.common, neutral) +
           (options.device.kind == DeviceRequest::Kind::Software ? "\nsoftware" : "");
}

TraceRecipes recipesOf(const TraceOptions& options) {
    if (!options.raysPath.empty() && options.common.jsonPath.empty())
        return {}; // hits carry none: spare the hashing
    std::vector<RecipeInput> inputs;
    for (const auto& [role, path] : inputsOf(options)) inputs.push_back({role, contentIdOf(path)});
    return {recipeOf(options.common.making, inputs),
            options.wholeMaking.empty() ? Recipe() : recipeOf(options.wholeMaking, inputs)};
}

TraceRecipes recipesOfFrame(const TraceRecipes& recipes, unsigned frame) {
    const auto ofFrame = [&](const Recipe& recipe) {
        return recipe.isKnown() ? Recipe(fmt::format("{}\nframe {}", recipe.text(), frame)) : Recipe();
    };
    return {ofFrame(recipes.own), ofFrame(recipes.whole)};
}

Recipe recipeOfReport(const TraceOptions& options, const Recipe& own) {
    if (!options.frames || !own.isKnown()) return own;
    return Recipe(fmt::format("{}\nframes {}-{}", own.text(), options.frames->first, options.frames->last));
}

void addRecipes(Image& image, const TraceRecipes& recipes) {
    if (recipes.own.isKnown()) image.texts[kRecipeKey] = recipes.own.mark();
    if (recipes.whole.isKnown()) image.texts[kWholeRecipeKey] = recipes.whole.text();
}

bool isUpToDate(const TraceOptions& options, const TraceRecipes& recipes) {
    return options.raysPath.empty() ? arePicturesUpToDate(options, recipes)
                                    : areHitsUpToDate(options, recipes.own);
}

} // namespace rt
