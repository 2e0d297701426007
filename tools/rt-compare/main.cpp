#include "common/run_tool.h"
#include "tools/rt-compare/pair_recipe.h"
#include "tools/rt-compare/report_files.h"
#include "tools/rt-compare/self_test.h"

namespace rt {
namespace {

int compareAll(const Options& options) {
    const std::vector<FilePair> pairs =
        options.listPath.empty() ? findPairs(options.pathA, options.pathB) : readPairList(options.listPath);
    const Recipe recipe = recipeOf(options, pairs);
    ReportFiles reports(options, pairs, recipe);
    int exitCode = 0;
    const auto isMade = [&](const std::string& output) { return carries(output, recipe); };
    if (!isUpToDate(options.common, outputsOf(options), isMade)) {
        exitCode = comparePairs(pairs, options, [&](const PairResult& result) { reports.add(result); });
        reports.finish();
    }
    writeDependencies(options.common, outputsOf(options), inputsOf(options, pairs));
    return exitCode;
}

int compare(int argc, const char* const* argv) {
    Options options;
    if (!parseOptions(argc, argv, options)) return 0;
    return options.selfTest ? runSelfTest(options) : compareAll(options);
}

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    return rt::runTool("rt-compare", argc, argv, rt::compare);
}
