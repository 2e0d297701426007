#pragma once
#include <span>
#include <string_view>

namespace rt {

struct EmbeddedShader {
    std::string_view path; ///< from the repository's root, as #include lines name it
    std::string_view text;
};

/// Every shaders/*.glsl and formats/*.shared.h, sorted by path.
std::span<const EmbeddedShader> embeddedShaders();

} // namespace rt
