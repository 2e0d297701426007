#include "tools/rt-import/mtl_statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rt {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// An option of a texture: what changes nothing. Words are one, numbers up to `mostNumbers`.
struct TextureOption {
    std::string_view name;
    std::size_t mostNumbers;
    double first, others;  // numbers
    std::string_view word; // or a word, of which "" stands for any
};
constexpr std::array<TextureOption, 12> kOptions{{{"-s", 3, 1.0, 1.0, ""},
                                                  {"-o", 3, 0.0, 0.0, ""},
                                                  {"-t", 3, 0.0, 0.0, ""},
                                                  {"-mm", 2, 0.0, 1.0, ""},
                                                  {"-boost", 1, 0.0, 0.0, ""},
                                                  {"-bm", 1, 1.0, 1.0, ""},
                                                  {"-clamp", 0, 0.0, 0.0, "off"},
                                                  {"-blendu", 0, 0.0, 0.0, "on"},
                                                  {"-blendv", 0, 0.0, 0.0, "on"},
                                                  {"-cc", 0, 0.0, 0.0, "off"},
                                                  {"-imfchan", 0, 0.0, 0.0, "l"},
                                                  {"-texres", 0, 0.0, 0.0, ""}}};

// Takes an option's values off the text; true if they change something.
bool takeValues(const TextureOption& option, std::string_view& text) {
    if (option.mostNumbers == 0) return takeWord(text) != option.word && !option.word.empty();
    bool changes = false;
    for (std::size_t i = 0; i < option.mostNumbers; ++i) {
        std::string_view rest = text;
        const auto number = numberOf(takeWord(rest));
        if (!number) return changes || i == 0;
        changes |= *number != (i == 0 ? option.first : option.others);
        text = rest;
    }
    return changes;
}

} // namespace

std::string_view trimmed(std::string_view text) {
    const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
    return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

std::string_view takeWord(std::string_view& text) {
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    text = trimmed(text.substr(word.size()));
    return word;
}

std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    while (!(line = trimmed(line)).empty()) {
        words.push_back(line.substr(0, line.find_first_of(kBlanks)));
        line.remove_prefix(words.back().size());
    }
    return words;
}

std::optional<double> numberOf(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0.0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool sound = status == std::errc() && end == word.data() + word.size() && std::isfinite(number);
    return sound ? std::optional(number) : std::nullopt;
}

bool isAll(std::string_view line, double value) {
    const std::vector<std::string_view> words = wordsOf(line);
    std::size_t same = 1;
    while (same < words.size() && numberOf(words[same]) == value) ++same;
    return same > 1 && (same == words.size() || words[same].starts_with('#'));
}

TextureStatement parseTexture(std::string_view text) {
    TextureStatement result;
    while (text.starts_with('-')) {
        std::string_view rest = text;
        const std::string_view name = takeWord(rest);
        if (rest.empty()) break;
        const auto option = std::find_if(kOptions.begin(), kOptions.end(),
                                         [&](const TextureOption& o) { return o.name == name; });
        if (option == kOptions.end()) {
            result.lost.push_back(name); // of who knows how many values
            text = wordsOf(rest).back();
            break;
        }
        const std::string_view values = rest;
        const bool changes = takeValues(*option, rest);
        const std::string_view taken = trimmed(values.substr(0, values.size() - rest.size()));
        if (name == "-clamp" ? taken == "on" : name == "-bm" && !taken.empty())
            result.kept += fmt::format("{} {} ", name, taken);
        else if (changes)
            result.lost.push_back(name);
        text = rest;
    }
    const std::string_view around = " \t\r\"'";
    const std::size_t first = std::min(text.find_first_not_of(around), text.size());
    result.name = text.substr(first, text.find_last_not_of(around) + 1 - first);
    if (result.name.starts_with('-'))
        result.name = {}; // an option to Assimp, which would read on in the next line
    return result;
}

} // namespace rt
