#include "tools/rt-trace/option_values.h"

#include "common/command_line.h"
#include "common/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <limits>

namespace rt {

glm::vec3 toColor(double r, double g, double b, const char* option) {
    if (std::min({r, g, b}) < 0.0)
        throw Error(ErrorKind::Usage, fmt::format("{}: colours are not negative", option));
    if (std::max({r, g, b}) > double(std::numeric_limits<float>::max()))
        throw Error(ErrorKind::Usage, fmt::format("{}: colours are 3.4e38 at most", option));
    return glm::vec3(glm::dvec3(r, g, b));
}

std::size_t countNumbers(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
}

glm::vec3 parseColor(const std::string& text, const char* option) {
    if (countNumbers(text) == 1) {
        const double grey = parseNumbers(text, 1, option)[0];
        return toColor(grey, grey, grey, option);
    }
    const std::vector<double> v = parseNumbers(text, 3, option);
    return toColor(v[0], v[1], v[2], option);
}

glm::dvec3 parsePoint(const std::string& text, const char* option) {
    const std::vector<double> v = parseNumbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

CLI::Validator oneOf(std::vector<std::string> names) {
    return CLI::IsMember(std::move(names)).description("");
}

CLI::Validator notNegative() {
    return {[](const std::string& text) -> std::string {
                double value = 0.0;
                const bool isNumber = CLI::detail::lexical_cast(text, value);
                return isNumber && value >= 0.0 ? "" : text + " is not a number of 0 or more";
            },
            ""};
}

CLI::Validator positive() {
    return {[](const std::string& text) -> std::string {
                double value = 0.0;
                const bool isNumber = CLI::detail::lexical_cast(text, value);
                return isNumber && value > 0.0 ? "" : text + " is not a number above 0";
            },
            ""};
}

} // namespace rt
