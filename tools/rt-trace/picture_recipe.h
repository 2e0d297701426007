#pragma once
#include "formats/image.h"
#include "formats/recipe.h"
#include "tools/rt-trace/options.h"

namespace rt {

/// Every file that a run with these options reads, but for --resume's: what was saved changes no picture.
std::vector<RecipeInput> inputsOf(const TraceOptions& options);

/// makingOf() the command line. The kind of device counts, hardware or software, but not which device it is.
/// `wholePicture`: of the picture that a shard is of.
std::string makingOf(const CLI::App& app, const TraceOptions& options, bool wholePicture);

struct PictureRecipes {
    Recipe own;
    Recipe whole; ///< of a part: that of the picture in one run; else not known
};
PictureRecipes recipesOf(const TraceOptions& options);
/// Those of one of several frames: the call's, and which one it is.
PictureRecipes recipesOfFrame(const PictureRecipes& recipes, unsigned frame);
/// That of the JSON file, which is of all frames.
Recipe recipeOfReport(const TraceOptions& options, const Recipe& own);

/// Sets the attributes.
void addRecipes(Image& image, const PictureRecipes& recipes);

/// Whether --if-changed is given and all pictures, of all frames, and the JSON file carry their recipes.
bool isUpToDate(const TraceOptions& options, const PictureRecipes& recipes);

/// The same of a ray query. Its JSON file carries the recipe, and the content id of the hits, which are bare
/// numbers, as kHitsIdKey.
bool areHitsUpToDate(const TraceOptions& options, const Recipe& recipe);
inline constexpr const char* kHitsIdKey = "hitsId";

} // namespace rt
