#include "common/binary_io.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/run_tool.h"
#include "tools/rt-compare/json_report.h"
#include "tools/rt-compare/run.h"
#include "tools/rt-compare/self_test.h"
#include "tools/rt-compare/text_report.h"

#include <nlohmann/json.hpp>

namespace rt {
namespace {

int compareAll(const Options& options) {
    const std::vector<FilePair> pairs =
        options.listPath.empty() ? findPairs(options.pathA, options.pathB) : readPairList(options.listPath);
    const bool printsText = !options.common.quiet && options.common.jsonPath != "-";
    nlohmann::json reports = nlohmann::json::array();
    std::size_t differing = 0, unreadable = 0;
    const int exitCode =
        comparePairs(pairs, options, [&](const PairResult& result, const PreparedPair* pair) {
            if (!options.common.jsonPath.empty()) reports.push_back(jsonReport(result, pair));
            if (printsText) writeFile("-", textReport(result, pair));
            differing += result.exitCode == kExitImagesDiffer ? 1u : 0u;
            unreadable += result.exitCode > kExitImagesDiffer ? 1u : 0u;
        });
    if (printsText && pairs.size() > 1) writeFile("-", textSummary(pairs.size(), differing, unreadable));
    if (!options.common.jsonPath.empty())
        writeJson(options.common.jsonPath, pairs.size() == 1 ? reports.front() : reports);
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
