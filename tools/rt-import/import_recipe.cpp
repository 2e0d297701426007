#include "tools/rt-import/import_recipe.h"

#include "common/binary_io.h"
#include "tools/rt-import/model_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace rt {
namespace {

// Loaders choose by the name of the file, and guess names of others by it; where it lies is not looked at.
std::vector<RecipeInput> inputsOf(const std::vector<std::string>& paths) {
    std::vector<RecipeInput> inputs;
    for (const std::string& path : paths)
        inputs.push_back({std::filesystem::path(path).filename().string(), contentIdOf(path)});
    return inputs;
}

// A folder of outputs is newer than they are after each run: what goes by its time would never be done.
bool holdsAnOutput(const std::filesystem::path& folder, const ImportOptions& options) {
    const std::filesystem::path real = realPath(folder);
    const std::vector<std::string> outputs = outputsOf(options);
    return std::any_of(outputs.begin(), outputs.end(), [&](const std::filesystem::path& output) {
        return real == realPath(output.has_parent_path() ? output.parent_path() : ".");
    });
}

} // namespace

ImportRecipe::ImportRecipe(const ImportOptions& options)
    : options_(options), asked_(options.sources.inputs, options.sources.roots),
      inputs_(recipeOf(fmt::format("{}\n{} roots", options.common.making, options.sources.roots.size()),
                       inputsOf(options.sources.inputs))) {}

bool ImportRecipe::isUpToDate() const {
    if (!options_.common.ifChanged || !inputs_.isKnown()) return false;
    const std::string before = recipeIn(options_.outputPath).text();
    if (!before.starts_with(inputs_.text())) return false;
    const std::string filesAsked = asked_.again(before.substr(inputs_.text().size()));
    const auto isMade = [recipe = with(filesAsked)](const std::string& output) {
        return carries(output, recipe);
    };
    if (!rt::isUpToDate(options_.common, outputsOf(options_), isMade)) return false;
    if (const auto text = dependencies(filesAsked)) writeFile(options_.common.depfilePath, *text);
    return true;
}

Recipe ImportRecipe::with(const std::string& filesAsked) const {
    return inputs_.isKnown() ? Recipe(inputs_.text() + filesAsked) : Recipe();
}

std::optional<std::string> ImportRecipe::dependencies(const std::string& filesAsked) const {
    std::vector<std::string> files = options_.sources.inputs;
    const std::vector<std::string> others = found(filesAsked);
    files.insert(files.end(), others.begin(), others.end());
    for (const std::string& folder : asked_.foldersOfMissing(filesAsked))
        if (!holdsAnOutput(folder, options_)) files.push_back(folder);
    return dependenciesText(options_.common, outputsOf(options_), files);
}

} // namespace rt
