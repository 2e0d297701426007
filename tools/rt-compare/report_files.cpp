#include "tools/rt-compare/report_files.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "common/log.h"
#include "tools/rt-compare/html_report.h"
#include "tools/rt-compare/json_report.h"
#include "tools/rt-compare/junit_report.h"
#include "tools/rt-compare/text_report.h"

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace rt {
namespace {

bool showsColors() {
    const char* const noColor = std::getenv("NO_COLOR");
    return isatty(STDOUT_FILENO) && !(noColor && *noColor);
}

void writeMaps(const ReportOptions& reports, const PairResult& result, const Recipe& recipe) {
    if (result.pair->layers.empty()) {
        logWarning(reports.heatPaths.front() + ": not written, the images have no pixels in common");
        return;
    }
    Image map = heatMap(*result.pair, result.maps, reports.heat);
    if (recipe.isKnown()) map.texts[kRecipeKey] = recipe.mark();
    std::vector<std::vector<std::byte>> files; // all encoded before the first is written
    for (const std::string& path : reports.heatPaths) files.push_back(sealed(encodeImage(path, map), recipe));
    for (std::size_t i = 0; i < files.size(); ++i) writeFile(reports.heatPaths[i], files[i]);
}

// Behind a page or XML document, where a comment may stand.
void writeMarked(const std::string& path, std::string text, const Recipe& recipe) {
    if (recipe.isKnown()) text += "<!-- " + recipe.mark() + " -->\n";
    writeFile(path, sealed(std::move(text), recipe));
}

} // namespace

ReportFiles::ReportFiles(const Options& options, const std::vector<FilePair>& pairs, const Recipe& recipe)
    : options_(options), recipe_(recipe),
      printsText_(!options.common.quiet && options.common.jsonPath != "-" &&
                  options.reports.junitPath != "-" && options.reports.htmlPath != "-"),
      pairs_(std::make_unique<nlohmann::json>(nlohmann::json::array())) {
    std::vector<std::string> inputs, outputs = options.reports.outputs();
    outputs.push_back(options.common.jsonPath);
    for (const FilePair& pair : pairs) {
        inputs.insert(inputs.end(), {pair.a, pair.b, secondPathFor(pair, options)});
    }
    requireDistinctPaths(inputs, outputs);
    if (pairs.size() > 1 && options.reports.showsPixels())
        throw Error(ErrorKind::Usage, "-o and --html show one pair of images; compare the two files alone");
}

ReportFiles::~ReportFiles() = default;

void ReportFiles::add(const PairResult& result) {
    const ReportOptions& reports = options_.reports;
    totals_.add(result.verdict());
    if (printsText_) writeFile("-", textReport(result, showsColors()));
    if (options_.common.jsonPath.empty() && reports.junitPath.empty() && reports.htmlPath.empty() &&
        reports.heatPaths.empty())
        return;
    pairs_->push_back(jsonReport(result));
    if (!result.pair) return;
    const Recipe recipe = result.verdict() == Verdict::Pass ? recipe_ : Recipe();
    if (!reports.htmlPath.empty()) writeMarked(reports.htmlPath, htmlReport(pairs_->back(), result), recipe);
    if (!reports.heatPaths.empty()) writeMaps(reports, result, recipe);
}

void ReportFiles::finish() {
    if (printsText_ && totals_.pairs > 1) writeFile("-", textSummary(totals_));
    const Recipe recipe = totals_.verdict() == Verdict::Pass ? recipe_ : Recipe();
    if (!options_.reports.junitPath.empty())
        writeMarked(options_.reports.junitPath, junitReport(*pairs_, totals_), recipe);
    if (!options_.common.jsonPath.empty())
        writeReport(options_.common.jsonPath, jsonFile(std::move(*pairs_), totals_), recipe);
}

} // namespace rt
