#include "tools/rt-trace/film.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace rt {
namespace {

void bindImage(GLuint unit, const GlTexture& texture, GLenum format) {
    glBindImageTexture(unit, texture.name(), 0, GL_FALSE, 0, GL_READ_WRITE, format);
}

template <class T>
std::vector<T> readAll(const GlTexture& texture, glm::uvec2 size, GLenum format, GLenum type) {
    std::vector<T> texels(std::size_t(size.x) * size.y);
    readTexels(texture, size.x, size.y, format, type, std::as_writable_bytes(std::span(texels)));
    return texels;
}

} // namespace

Film::Film(glm::uvec2 size, bool countWork, const GlLimits& limits) : size_(size) {
    if (size.x > limits.textureSize2D || size.y > limits.textureSize2D)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("--size {}x{}: this device renders at most {}x{}", size.x, size.y,
                                limits.textureSize2D, limits.textureSize2D));
    color_ = createTexture2D(GL_RGBA32F, size.x, size.y);
    surface_ = createTexture2D(GL_RGBA32F, size.x, size.y);
    id_ = createTexture2D(GL_R32UI, size.x, size.y);
    if (countWork) counters_ = createTexture2D(GL_RGBA32UI, size.x, size.y);
}

void Film::bind() const {
    bindImage(RT_IMAGE_COLOR, color_, GL_RGBA32F);
    bindImage(RT_IMAGE_SURFACE, surface_, GL_RGBA32F);
    bindImage(RT_IMAGE_ID, id_, GL_R32UI);
    if (counters_.name()) bindImage(RT_IMAGE_COUNTERS, counters_, GL_RGBA32UI);
    checkGl("binding the film");
}

FilmPixels Film::read() const {
    return {readAll<glm::vec4>(color_, size_, GL_RGBA, GL_FLOAT),
            readAll<glm::vec4>(surface_, size_, GL_RGBA, GL_FLOAT),
            readAll<std::uint32_t>(id_, size_, GL_RED_INTEGER, GL_UNSIGNED_INT)};
}

std::vector<glm::uvec4> Film::readCounters() const {
    return readAll<glm::uvec4>(counters_, size_, GL_RGBA_INTEGER, GL_UNSIGNED_INT);
}

} // namespace rt
