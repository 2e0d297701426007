#pragma once
#include <glm/vec3.hpp>
#include <string>

namespace rt {

/// "G" or "R,G,B", none of them negative. Throws Error{Usage} naming `option`.
glm::vec3 parseColor(const std::string& text, const char* option);

/// Throws Error{Usage} naming `option` if one of them is negative.
glm::vec3 toColor(double r, double g, double b, const char* option);

/// How many numbers commas separate.
std::size_t countNumbers(const std::string& text);

} // namespace rt
