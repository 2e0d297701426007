#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// What an output was made of, and how: the tool and its version, the options that decide it and the content
/// of all inputs. Equal recipes make equal outputs, but for what a clock says. Every output carries its
/// recipe; README.md says where.
class Recipe {
public:
    Recipe() = default; ///< not known: no output carries it
    explicit Recipe(std::string text) : text_(std::move(text)) {}

    bool isKnown() const { return !text_.empty(); }
    /// As a container holds it.
    const std::string& text() const { return text_; }
    /// "rt-recipe:", XXH3 of the text, ':' and 16 zeros for sealed(); empty if the recipe is not known. For
    /// all other files, which have it once, where their format has room for text.
    std::string mark() const;

private:
    std::string text_;
};

/// The name under which pictures and reports have the mark.
inline constexpr const char* kRecipeKey = "rt:recipe";
inline constexpr std::size_t kRecipeIdDigits = 16;

/// 16 hexadecimal digits that are the same for the same content, whatever recipe made it: of .rtmesh and
/// .rtatlas files those of the content hash in the header, of others XXH3 of their bytes without a mark.
std::string contentIdOf(std::span<const std::byte> file);
/// Nothing if it is no regular file, which streams are not, or cannot be read. For a recipe to be called
/// before the tool reads the file: what changes in between is then taken for a change.
std::optional<std::string> contentIdOf(const std::string& path);

/// A file, and what it is to the tool: content in another role makes another recipe, another name does not.
struct RecipeInput {
    std::string role;
    std::optional<std::string> contentId; ///< see contentIdOf()
};

/// `making`: see makingOf(). Not known if that of an input is not.
Recipe recipeOf(const std::string& making, const std::vector<RecipeInput>& inputs);

/// The bytes of a file that holds the recipe's mark, with the hash of all of them in place of its zeros.
std::vector<std::byte> sealed(std::vector<std::byte> bytes, const Recipe& recipe);
std::string sealed(std::string bytes, const Recipe& recipe);

/// Of a .rtmesh or .rtatlas; not known of what is none or has none.
Recipe recipeIn(const std::string& path);

/// The report as JSON, with the recipe's mark as "recipe".
std::string reportText(nlohmann::json report, const Recipe& recipe);
/// Writes reportText(); "-" is standard output. Throws Error{FileAccess}.
void writeReport(const std::string& path, nlohmann::json report, const Recipe& recipe);

/// Whether the file was made by the recipe and is whole: each of its bytes is covered by a hash.
bool carries(const std::string& path, const Recipe& recipe);

/// Whether a picture or report that has a mark has changed since it was sealed. False without a mark.
bool isSealBroken(std::span<const std::byte> bytes);

} // namespace rt
