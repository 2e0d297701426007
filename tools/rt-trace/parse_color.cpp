#include "tools/rt-trace/parse_color.h"

#include "common/command_line.h"
#include "common/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {

glm::vec3 toColor(double r, double g, double b, const char* option) {
    if (std::min({r, g, b}) < 0.0)
        throw Error(ErrorKind::Usage, fmt::format("{}: colours are not negative", option));
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

} // namespace rt
