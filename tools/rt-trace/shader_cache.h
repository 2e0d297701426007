#pragma once
#include "tools/rt-trace/gl_objects.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rt {

/// $XDG_CACHE_HOME/rt-tools, else ~/.cache/rt-tools, which is made if it is not there. Nothing if neither can
/// be written, or RT_NO_SHADER_CACHE is set and not empty.
std::optional<std::filesystem::path> shaderCacheFolder();

/// Shaders as the driver compiled them in earlier runs, in files named after a hash of the whole source and
/// the driver's names and version. Nothing that is wrong with a file is an error: such a shader is compiled,
/// and replaces it.
class ShaderCache {
public:
    static constexpr std::uint64_t kMostBytes = 64u << 20;

    /// For the current context, whose driver must have a binary format (GlLimits::programBinaries). The files
    /// used longest ago go when all have more than `mostBytes`.
    explicit ShaderCache(std::filesystem::path folder, std::uint64_t mostBytes = kMostBytes);

    /// No name if there is none of this source that the driver takes.
    GlProgram load(const std::string& source) const;
    /// `program` is linked, and was to be GL_PROGRAM_BINARY_RETRIEVABLE_HINT.
    void store(const std::string& source, const GlProgram& program) const;

private:
    std::uint64_t keyOf(const std::string& source) const;
    std::filesystem::path fileOf(std::uint64_t key) const;
    void dropOldest() const;

    std::filesystem::path folder_;
    std::uint64_t mostBytes_;
    std::string driver_; // names and version
};

} // namespace rt
