#include "tools/rt-compare/pair_recipe.h"

#include <algorithm>

namespace rt {

std::vector<std::string> inputsOf(const Options& options, const std::vector<FilePair>& pairs) {
    std::vector<std::string> paths{options.listPath, options.maskPath};
    for (const FilePair& pair : pairs) {
        const bool isWhole = !pair.a.empty() && !pair.b.empty(); // else neither is read
        if (isWhole) paths.insert(paths.end(), {pair.a, pair.b, secondPathFor(pair, options)});
    }
    std::erase(paths, "");
    return paths;
}

Recipe recipeOf(const Options& options, const std::vector<FilePair>& pairs) {
    std::string making = options.common.making;
    for (const FilePair& pair : pairs) making += '\n' + pair.a + '\0' + pair.b;
    std::vector<RecipeInput> inputs;
    if (!options.maskPath.empty()) inputs.push_back({"--mask", contentIdOf(options.maskPath)});
    for (const std::string& path : inputsOf(options, pairs))
        if (path != options.listPath) // what that names is in `making`
            inputs.push_back({path, contentIdOf(path)});
    return recipeOf(making, inputs);
}

} // namespace rt
