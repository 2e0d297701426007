#include "tools/rt-trace/shader_cache.h"

#include "common/error.h"
#include "common/log.h"
#include "formats/checkpoint_file.h"
#include "formats/shader_binary_file.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <unistd.h>
#include <vector>

namespace rt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".rtshader";

std::string environmentOf(const char* name) {
    const char* const value = std::getenv(name);
    return value ? value : "";
}

std::string glText(GLenum name) {
    const GLubyte* const text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

// A cache only saves time: what goes wrong there is worth a remark, not an end.
template <class Work>
void attempt(const char* what, const Work& work) {
    try {
        work();
    } catch (const Error& error) {
        logDetail(fmt::format("{}: {}", what, error.what()));
    }
}

GlProgram programOf(const ShaderBinary& binary) {
    GlProgram program(glCreateProgram());
    glProgramBinary(program.name(), binary.format, binary.bytes.data(),
                    static_cast<GLsizei>(binary.bytes.size()));
    GLint linked = GL_FALSE;
    glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
    while (glGetError() != GL_NO_ERROR) { // a format that this driver no longer knows
        linked = GL_FALSE;
    }
    return linked ? std::move(program) : GlProgram();
}

} // namespace

std::optional<fs::path> shaderCacheFolder() {
    if (!environmentOf("RT_NO_SHADER_CACHE").empty()) return std::nullopt;
    const std::string home = environmentOf("HOME");
    for (const fs::path& base :
         {fs::path(environmentOf("XDG_CACHE_HOME")), home.empty() ? fs::path() : fs::path(home) / ".cache"}) {
        if (!base.is_absolute()) continue;
        const fs::path folder = base / "rt-tools";
        std::error_code failed;
        fs::create_directories(folder, failed);
        if (!failed && access(folder.c_str(), R_OK | W_OK | X_OK) == 0) return folder;
    }
    return std::nullopt;
}

ShaderCache::ShaderCache(fs::path folder, std::uint64_t mostBytes)
    : folder_(std::move(folder)), mostBytes_(mostBytes),
      driver_(fmt::format("{}\n{}\n{}\n", glText(GL_VENDOR), glText(GL_RENDERER), glText(GL_VERSION))) {}

std::uint64_t ShaderCache::keyOf(const std::string& source) const {
    const std::string all = driver_ + source;
    return hashOf(std::as_bytes(std::span(all)));
}

fs::path ShaderCache::fileOf(std::uint64_t key) const {
    return folder_ / fmt::format("{:016x}{}", key, kExtension);
}

GlProgram ShaderCache::load(const std::string& source) const {
    const std::uint64_t key = keyOf(source);
    const fs::path path = fileOf(key);
    std::error_code failed;
    if (!fs::is_regular_file(path, failed)) return {}; // a pipe might never end
    GlProgram program;
    attempt("no shader from the cache", [&] {
        const ShaderBinary binary = readShaderBinary(path.string());
        if (binary.key == key) program = programOf(binary);
    });
    if (program.name()) fs::last_write_time(path, fs::file_time_type::clock::now(), failed);
    return program;
}

void ShaderCache::store(const std::string& source, const GlProgram& program) const {
    GLint length = 0;
    glGetProgramiv(program.name(), GL_PROGRAM_BINARY_LENGTH, &length);
    if (length <= 0) return;
    std::vector<std::byte> bytes(static_cast<std::size_t>(length));
    GLenum format = 0;
    glGetProgramBinary(program.name(), length, &length, &format, bytes.data());
    if (glGetError() != GL_NO_ERROR || length <= 0) return;
    bytes.resize(static_cast<std::size_t>(length));
    const std::uint64_t key = keyOf(source);
    const fs::path path = fileOf(key);
    std::error_code failed;
    if (fs::exists(path, failed) && !fs::is_regular_file(path, failed)) return;
    attempt("the shader is not kept", [&] {
        writeShaderBinary(path.string(), {key, format, std::move(bytes)});
    });
    dropOldest();
}

void ShaderCache::dropOldest() const {
    struct File {
        fs::file_time_type used;
        std::uint64_t bytes;
        fs::path path;
    };
    std::vector<File> files;
    std::uint64_t total = 0;
    std::error_code failed; // others may be dropping files too
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, failed)) {
        if (entry.path().extension() != kExtension || !entry.is_regular_file(failed)) continue;
        const File file{entry.last_write_time(failed), entry.file_size(failed), entry.path()};
        if (failed) continue;
        total += file.bytes;
        files.push_back(file);
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.used < b.used; });
    for (std::size_t i = 0; i < files.size() && total > mostBytes_; ++i)
        if (fs::remove(files[i].path, failed)) total -= files[i].bytes;
}

} // namespace rt
