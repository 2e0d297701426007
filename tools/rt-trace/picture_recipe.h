#pragma once
#include "tools/rt-trace/options.h"

namespace rt {

/// Every file that a run with these options reads, but for --resume's: what was saved changes no picture.
std::vector<RecipeInput> inputsOf(const TraceOptions& options);

/// makingOf() the command line. The kind of device counts, hardware or software, but not which device it is.
/// `wholePicture`: of the picture that a shard is of.
std::string makingOf(const CLI::App& app, const TraceOptions& options, bool wholePicture);

/// That of one of several frames: the call's, and which one it is.
Recipe recipeOfFrame(const Recipe& recipe, unsigned frame);
/// That of the JSON file, which is of all frames.
Recipe recipeOfReport(const TraceOptions& options);

/// Whether --if-changed is given and all pictures, of all frames, and the JSON file carry options.recipe.
bool isUpToDate(const TraceOptions& options);

} // namespace rt
