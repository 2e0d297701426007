#include "tools/rt-trace/picture_recipe.h"

#include "formats/environment_picture.h"

namespace rt {

std::vector<RecipeInput> inputsOf(const TraceOptions& options) {
    std::vector<RecipeInput> inputs{{"scene", options.scenePath}};
    if (!options.raysPath.empty()) inputs.push_back({"--rays", options.raysPath});
    if (!options.cameraPath.empty()) inputs.push_back({"--camera-path", options.cameraPath});
    if (isEnvironmentFile(options.environment)) inputs.push_back({"--environment", options.environment});
    return inputs;
}

std::string makingOf(const CLI::App& app, const TraceOptions& options, bool wholePicture) {
    std::vector<std::string> neutral{
        "scene",        "--rays",           "--camera-path", "--device",         "--resume",
        "--checkpoint", "--max-gpu-memory", "--explain",     "--no-shader-cache"};
    if (isEnvironmentFile(options.environment)) neutral.push_back("--environment");
    if (wholePicture) neutral.insert(neutral.end(), {"--shard", "--shard-by"});
    return makingOf(app, options.common, neutral) + (options.device == "software" ? "\nsoftware" : "");
}

bool isUpToDate(const TraceOptions& options) {
    std::vector<std::string> outputs;
    const FrameRange frames = options.frames.value_or(FrameRange{});
    for (const std::string& path : options.outputPaths)
        for (std::uint64_t frame = frames.first; frame <= frames.last; ++frame)
            outputs.push_back(framePath(path, static_cast<unsigned>(frame)).value_or(path));
    if (!options.common.jsonPath.empty()) outputs.push_back(options.common.jsonPath);
    return isUpToDate(options.common, std::move(outputs), options.recipe);
}

} // namespace rt
