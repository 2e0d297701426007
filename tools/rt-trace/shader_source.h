#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rt {

/// A whole shader. Its #line directives number the files that it was put together from.
struct ShaderText {
    std::string text;
    std::vector<std::string> files; ///< files[n] is what `#line L n` calls n
};

/// Text of the file that an #include line names, or nothing.
using ShaderFinder = std::function<std::optional<std::string>(std::string_view path)>;

/// Text of a shaders/*.glsl or formats/*.shared.h as it was when the program was built.
std::optional<std::string> embeddedShader(std::string_view path);

/// `prelude` (which begins with #version) followed by the file `entry`, with every #include "path" replaced
/// by that file the first time and by nothing later on. What stands under #ifdef __cplusplus is left out.
/// Throws Error{Internal} for a file that `find` does not know.
ShaderText composeShader(const std::string& prelude, const std::string& entry, const ShaderFinder& find);

/// The driver's log with the numbers that it begins lines with, as in "2:17(3)" or "2(17)", replaced by file
/// names.
std::string nameFiles(const std::string& compilerLog, const ShaderText& shader);

} // namespace rt
