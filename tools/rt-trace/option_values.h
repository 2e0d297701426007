#pragma once
#include <algorithm>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace CLI {
class Validator;
}

namespace rt {

/// Throws Error{Usage} naming `option` for a negative colour.
glm::vec3 toColor(double r, double g, double b, const char* option);
/// Numbers between commas.
std::size_t countNumbers(const std::string& text);
/// "G" or "R,G,B". Throws Error{Usage} naming `option`.
glm::vec3 parseColor(const std::string& text, const char* option);
/// "X,Y,Z". Throws Error{Usage} naming `option`.
glm::dvec3 parsePoint(const std::string& text, const char* option);

// For CLI::Option::check(). What --help shows of them stands in the type's name.
CLI::Validator oneOf(std::vector<std::string> names);
CLI::Validator notNegative();
CLI::Validator positive();

/// Where the name stands among the names.
template <class Names>
unsigned indexIn(const Names& names, const std::string& name) {
    return static_cast<unsigned>(std::find(names.begin(), names.end(), name) - names.begin());
}
template <class Names>
std::vector<std::string> listOf(const Names& names) {
    return {names.begin(), names.end()};
}

} // namespace rt
