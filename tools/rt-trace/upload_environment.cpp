#include "tools/rt-trace/upload_environment.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace rt {
namespace {

void requireRoom(const EnvironmentMap& map, const GlLimits& limits, const std::string& name) {
    if (map.width > limits.textureSize2D || map.height > limits.textureSize2D)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: {}x{} pixels; this device allows {} on a side; scale it down", name,
                                map.width, map.height, limits.textureSize2D));
    if (map.cdf.size() * sizeof(float) > limits.resources.storageBlockBytes)
        throw Error(
            ErrorKind::LimitExceeded,
            fmt::format("{}: {}x{} pixels need a table of {} bytes; this device allows {}; scale it down",
                        name, map.width, map.height, map.cdf.size() * sizeof(float),
                        limits.resources.storageBlockBytes));
}

} // namespace

GpuEnvironment::GpuEnvironment(const EnvironmentMap& map, const GlLimits& limits, const std::string& name) {
    requireRoom(map, limits, name);
    texture_ = createTexture2D(GL_RGB32F, map.width, map.height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(texture_.name(), 0, 0, 0, static_cast<GLsizei>(map.width),
                        static_cast<GLsizei>(map.height), GL_RGB, GL_FLOAT, map.pixels.data());
    // Round the horizon the picture has no border.
    glTextureParameteri(texture_.name(), GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(texture_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    table_ = createBuffer(std::as_bytes(std::span(map.cdf)));
    checkGl("uploading the environment");
}

std::uint64_t GpuEnvironment::bytesFor(const EnvironmentMap& map) {
    return map.pixels.size() * sizeof(glm::vec4) + map.cdf.size() * sizeof(float); // devices pad three floats
}

void GpuEnvironment::bind() const {
    glBindTextureUnit(RT_TEXTURE_ENVIRONMENT, texture_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RT_BUFFER_ENVIRONMENT, table_.name());
    checkGl("binding the environment");
}

} // namespace rt
