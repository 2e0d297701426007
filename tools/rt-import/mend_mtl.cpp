#include "tools/rt-import/mend_mtl.h"

#include <assimp/material.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rt {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
    return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    while (!(line = trimmed(line)).empty()) {
        words.push_back(line.substr(0, line.find_first_of(kBlanks)));
        line.remove_prefix(words.back().size());
    }
    return words;
}

bool isNumber(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0.0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    return status == std::errc() && end == word.data() + word.size() && std::isfinite(number);
}

template <std::size_t N>
bool isOneOf(std::string_view word, const std::array<std::string_view, N>& list) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

// What Assimp, which looks at the first letters only, reads as a number or a colour.
bool takesNumbers(std::string_view key) {
    constexpr std::array<std::string_view, 2> kOthers{"norm", "disp"};
    return std::string_view("kKTdnNPai").find(key.front()) != std::string_view::npos &&
           !isOneOf(key, kOthers) && !key.starts_with("new");
}

// Empty for a statement that makes no sense.
std::string mended(std::string_view line) {
    constexpr std::array<std::string_view, 10> kColors{"Ka", "Kd", "Ks", "Ke", "ka",
                                                       "kd", "ks", "ke", "Tf", "Ps"};
    constexpr std::array<std::string_view, 13> kNumbers{"illum", "Tr", "d",  "Ns",  "Ni",    "ns",    "ni",
                                                        "Pr",    "Pm", "Pc", "Pcr", "aniso", "anisor"};
    const std::vector<std::string_view> words = wordsOf(line);
    const auto numbers = static_cast<std::size_t>(std::find_if_not(words.begin() + 1, words.end(), isNumber) -
                                                  words.begin() - 1);
    if (isOneOf(words[0], kNumbers) && numbers >= 1) return std::string(line);
    if (!isOneOf(words[0], kColors) || numbers < 1) return "";
    if (numbers >= 3) return std::string(line);
    const bool isAll = words.size() == numbers + 1 || words[numbers + 1].starts_with('#');
    return numbers == 1 && isAll ? fmt::format("{0} {1} {1} {1}", words[0], words[1]) : "";
}

} // namespace

std::string mendMtl(std::string_view text, const std::string& path, std::set<std::string>& names,
                    std::vector<std::string>& warnings) {
    constexpr std::size_t kMostShown = 60;
    std::string result;
    bool hasMaterial = false;
    for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view raw = text.substr(at, end - at), line = trimmed(raw);
        at = end + 1;
        const std::string_view key = line.substr(0, line.find_first_of(kBlanks));
        if (key == "newmtl") {
            hasMaterial = true;
            const std::string_view name = trimmed(line.substr(key.size()));
            names.insert(name.empty() ? AI_DEFAULT_MATERIAL_NAME : std::string(name));
        }
        if (key.empty() || !takesNumbers(key)) {
            result += std::string(raw) + '\n';
            continue;
        }
        const std::string statement = hasMaterial ? mended(line) : "";
        if (statement.empty())
            warnings.push_back(fmt::format(
                "{}: line {}: '{}' {}; it is left out", path, number, line.substr(0, kMostShown),
                hasMaterial ? "has not the numbers that it needs" : "stands before the first material"));
        result += statement + '\n';
    }
    return result;
}

} // namespace rt
