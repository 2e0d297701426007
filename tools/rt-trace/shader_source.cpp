#include "tools/rt-trace/shader_source.h"

#include "common/error.h"
#include "shaders/embedded_shaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace rt {
namespace {

// Follows #if nesting as far as it takes to know which lines only C++ sees.
class ConditionalStack {
public:
    // True if the line itself opens, turns or closes a conditional.
    bool read(std::istringstream words) {
        std::string directive, condition;
        words >> directive >> condition;
        if (directive == "#if" || directive == "#ifdef" || directive == "#ifndef") {
            const bool onLanguage = directive != "#if" && condition == "__cplusplus";
            levels_.push_back(!onLanguage ? Level::Other : directive == "#ifdef" ? Level::Cpp : Level::Glsl);
        } else if (directive == "#else" && !levels_.empty()) {
            Level& level = levels_.back();
            level = level == Level::Cpp ? Level::Glsl : level == Level::Glsl ? Level::Cpp : Level::Other;
        } else if (directive == "#endif" && !levels_.empty()) {
            levels_.pop_back();
        } else {
            return false;
        }
        return true;
    }
    bool inCpp() const { return std::find(levels_.begin(), levels_.end(), Level::Cpp) != levels_.end(); }

private:
    enum class Level { Other, Cpp, Glsl };
    std::vector<Level> levels_;
};

std::optional<std::string> includedPath(const std::string& line) {
    std::istringstream words(line);
    std::string directive, path;
    words >> directive >> path;
    if (directive != "#include" || path.size() < 2 || path.front() != '"' || path.back() != '"')
        return std::nullopt;
    return path.substr(1, path.size() - 2);
}

class Composer {
public:
    Composer(const std::string& prelude, const ShaderFinder& find) : find_(find) {
        shader_.text = prelude;
        shader_.files.push_back("prelude");
    }

    void append(const std::string& path, const std::string& includedFrom) {
        if (std::find(shader_.files.begin(), shader_.files.end(), path) != shader_.files.end()) return;
        const std::optional<std::string> text = find_(path);
        if (!text)
            throw Error(ErrorKind::Internal,
                        fmt::format("{} includes {}, which is not there", includedFrom, path));
        const std::size_t number = shader_.files.size();
        shader_.files.push_back(path);
        shader_.text += fmt::format("#line 1 {}\n", number);
        std::istringstream lines(*text);
        ConditionalStack conditionals;
        int lineNumber = 0;
        for (std::string line; std::getline(lines, line);) {
            ++lineNumber;
            const bool conditional = conditionals.read(std::istringstream(line));
            const std::optional<std::string> inner = conditionals.inCpp() ? std::nullopt : includedPath(line);
            if (inner) {
                append(*inner, path);
                shader_.text += fmt::format("#line {} {}\n", lineNumber + 1, number);
            } else {
                shader_.text += (conditionals.inCpp() && !conditional ? "" : line) + "\n";
            }
        }
    }

    ShaderText take() { return std::move(shader_); }

private:
    const ShaderFinder& find_;
    ShaderText shader_;
};

} // namespace

std::optional<std::string> embeddedShader(std::string_view path) {
    for (const EmbeddedShader& shader : embeddedShaders())
        if (shader.path == path) return std::string(shader.text);
    return std::nullopt;
}

ShaderText composeShader(const std::string& prelude, const std::string& entry, const ShaderFinder& find) {
    Composer composer(prelude, find);
    composer.append(entry, "the program");
    return composer.take();
}

std::string nameFiles(const std::string& compilerLog, const ShaderText& shader) {
    std::istringstream lines(compilerLog);
    std::string named;
    for (std::string line; std::getline(lines, line); named += line + "\n") {
        std::size_t number = 0;
        const char* const end = line.data() + line.size();
        const auto [rest, status] = std::from_chars(line.data(), end, number);
        const bool isPlace = status == std::errc() && rest != end && (*rest == ':' || *rest == '(');
        if (isPlace && number < shader.files.size()) line = shader.files[number] + std::string(rest, end);
    }
    return named;
}

} // namespace rt
