#pragma once
#include "formats/image.h"
#include "formats/recipe.h"
#include "tools/rt-trace/options.h"

namespace rt {

struct InputFile {
    std::string role; ///< see RecipeInput
    std::string path;
};

/// Every file that a run with these options reads, but for --resume's: what was saved changes no picture.
std::vector<InputFile> inputsOf(const TraceOptions& options);

/// makingOf() the command line. The kind of device counts, hardware or software, but not which device it is.
/// `wholePicture`: of the picture that a shard is of.
std::string makingOf(const CLI::App& app, const TraceOptions& options, bool wholePicture);

struct TraceRecipes {
    Recipe own;   ///< of the picture or of the hits
    Recipe whole; ///< of a part: that of the picture in one run; else not known
};
TraceRecipes recipesOf(const TraceOptions& options);
/// Those of one of several frames: the call's, and which one it is.
TraceRecipes recipesOfFrame(const TraceRecipes& recipes, unsigned frame);
/// That of the JSON file, which is of all frames.
Recipe recipeOfReport(const TraceOptions& options, const Recipe& own);

/// Sets the attributes.
void addRecipes(Image& image, const TraceRecipes& recipes);

/// Whether --if-changed is given and all outputs are as this run would make them: pictures, of all frames,
/// and the JSON file carry their recipes. Hits are bare numbers: the JSON file has their content id as
/// kHitsIdKey.
bool isUpToDate(const TraceOptions& options, const TraceRecipes& recipes);
inline constexpr const char* kHitsIdKey = "hitsId";

} // namespace rt
