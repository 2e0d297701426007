#include "tools/rt-compare/junit_report.h"

#include "tools/rt-compare/finding.h"
#include "tools/rt-compare/markup.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <vector>

namespace rt {
namespace {

// Bytes that are not UTF-8, which file names may hold, become the replacement character.
std::string textOf(const nlohmann::json& value) {
    const std::string quoted = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return escapedMarkup(nlohmann::json::parse(quoted).get<std::string>());
}

// What fails, a line each.
std::vector<std::string> problemsOf(const nlohmann::json& pair) {
    if (pair.contains("problem")) return {textOf(pair.at("problem"))};
    std::vector<std::string> problems;
    for (const nlohmann::json& finding : pair.at("findings"))
        if (finding.at("fails").get<bool>()) problems.push_back(textOf(finding.at("text")));
    return problems;
}

// The kind of what fails first.
std::string typeOf(const nlohmann::json& pair) {
    if (pair.at("verdict") == verdictName(Verdict::Error)) return verdictName(Verdict::Error);
    if (pair.contains("problem")) return traitsOf(FindingKind::Files).name;
    for (const nlohmann::json& finding : pair.at("findings"))
        if (finding.at("fails").get<bool>()) return finding.at("kind").get<std::string>();
    return {};
}

std::string fileOf(const nlohmann::json& picture) {
    return picture.at("file").is_null() ? "(no file)" : textOf(picture.at("file"));
}

std::string testCase(const nlohmann::json& pair) {
    const std::string head = fmt::format("  <testcase classname=\"rt-compare\" name=\"{} against {}\"",
                                         fileOf(pair.at("a")), fileOf(pair.at("b")));
    const auto& verdict = pair.at("verdict");
    if (verdict == verdictName(Verdict::Pass)) return head + "/>\n";
    const char* const kind = verdict == verdictName(Verdict::Fail) ? "failure" : "error";
    const std::vector<std::string> problems = problemsOf(pair);
    return fmt::format("{}>\n    <{} type=\"{}\" message=\"{}\">{}</{}>\n  </testcase>\n", head, kind,
                       typeOf(pair), problems.empty() ? "" : problems.front(), fmt::join(problems, "\n"),
                       kind);
}

} // namespace

std::string junitReport(const nlohmann::json& pairs, const Totals& totals) {
    std::string cases;
    for (const nlohmann::json& pair : pairs) cases += testCase(pair);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuite name=\"rt-compare\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n{}</testsuite>\n",
        totals.pairs, totals.failing, totals.unreadable, cases);
}

} // namespace rt
