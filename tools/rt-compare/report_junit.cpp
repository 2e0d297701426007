#include "tools/rt-compare/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rt {
namespace {

// XML has no place for other control characters, not even escaped.
std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    }
    return result;
}

// Bytes that are not UTF-8, which file names may hold, become the replacement character.
std::string textOf(const nlohmann::json& value) {
    const std::string quoted = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return escaped(nlohmann::json::parse(quoted).get<std::string>());
}

std::string testCase(const nlohmann::json& pair) {
    std::string failures;
    std::string first;
    for (const nlohmann::json& finding : pair.at("findings")) {
        if (!finding.at("fails").get<bool>()) continue;
        const std::string text = textOf(finding.at("text"));
        if (first.empty()) first = text;
        failures += text + "\n";
    }
    const std::string head = fmt::format("  <testcase classname=\"rt-compare\" name=\"{} against {}\"",
                                         textOf(pair.at("a").at("file")), textOf(pair.at("b").at("file")));
    if (pair.at("verdict") == "pass") return head + "/>\n";
    return fmt::format("{}>\n    <failure message=\"{}\">{}</failure>\n  </testcase>\n", head, first, failures);
}

} // namespace

std::string junitReport(const nlohmann::json& pairs) {
    std::string cases;
    std::size_t failures = 0;
    for (const nlohmann::json& pair : pairs) {
        cases += testCase(pair);
        failures += pair.at("verdict") == "pass" ? 0u : 1u;
    }
    return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                       "<testsuite name=\"rt-compare\" tests=\"{}\" failures=\"{}\" errors=\"0\">\n{}</testsuite>\n",
                       pairs.size(), failures, cases);
}

} // namespace rt
