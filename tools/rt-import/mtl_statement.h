#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The parts of a line of an MTL file.

namespace rt {

/// Without blanks around it.
std::string_view trimmed(std::string_view text);
/// Takes the first word off a text, and the blanks behind it.
std::string_view takeWord(std::string_view& text);
std::vector<std::string_view> wordsOf(std::string_view line);
/// Nothing if the word is no finite number.
std::optional<double> numberOf(std::string_view word);
/// Whether all of the numbers behind a statement's key are this one, and there is one at least.
bool isAll(std::string_view line, double value);

/// What stands behind the key of a texture.
struct TextureStatement {
    std::string kept;                   ///< options that Assimp reads
    std::string_view name;              ///< without blanks or quotes around it
    std::vector<std::string_view> lost; ///< options that change something and are not among those
};

TextureStatement parseTexture(std::string_view text);

} // namespace rt
