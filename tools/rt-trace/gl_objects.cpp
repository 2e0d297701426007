#include "tools/rt-trace/gl_objects.h"

#include "common/error.h"
#include "tools/rt-trace/shader_cache.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace rt {
namespace {

constexpr std::uint64_t kTransferBytes =
    64u << 20; // of a picture at a time: drivers copy each piece, and count its bytes in 31 bits

GLsizei toSize(unsigned value) {
    return static_cast<GLsizei>(value);
}

void requireAddressable(std::uint64_t bytes) {
    if (bytes > static_cast<std::uint64_t>(std::numeric_limits<GLsizeiptr>::max()))
        throw Error(ErrorKind::LimitExceeded, fmt::format("a buffer of {} bytes is too large", bytes));
}

template <class GetParameter, class GetLog>
std::string logOf(GLuint object, GetParameter getParameter, GetLog getLog) {
    GLint length = 0;
    getParameter(object, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    GLsizei written = 0;
    getLog(object, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

// Without it a texture of integers, or one that lacks mipmaps, is incomplete: image stores then do nothing.
void filterByNearest(GLuint texture) {
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

GlBuffer createEmptyBuffer(std::uint64_t size, GLbitfield flags, const char* remedy) {
    requireAddressable(size);
    GLuint name = 0;
    glCreateBuffers(1, &name);
    GlBuffer buffer(name);
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(std::max<std::uint64_t>(size, 16)), nullptr, flags);
    checkGl(fmt::format("making a buffer of {} bytes", size), remedy);
    return buffer;
}

} // namespace

void deleteBuffer(GlName name) {
    glDeleteBuffers(1, &name);
}
void deleteTexture(GlName name) {
    glDeleteTextures(1, &name);
}
void deleteProgram(GlName name) {
    glDeleteProgram(name);
}
void deleteQuery(GlName name) {
    glDeleteQueries(1, &name);
}

void deleteShader(GlName name) {
    glDeleteShader(name);
}

void deleteFramebuffer(GlName name) {
    glDeleteFramebuffers(1, &name);
}
void deleteVertexArray(GlName name) {
    glDeleteVertexArrays(1, &name);
}

void GlFence::Delete::operator()(void* sync) const {
    glDeleteSync(static_cast<GLsync>(sync));
}

GlFence GlFence::insert() {
    GlFence fence;
    fence.sync_.reset(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0));
    if (!fence.sync_) throw Error(ErrorKind::Internal, "the device takes no more work");
    return fence;
}

void GlFence::wait() {
    constexpr GLuint64 kNanoseconds = 60'000'000'000; // no copy of a piece takes a minute
    if (!sync_) return;
    const GLenum result =
        glClientWaitSync(static_cast<GLsync>(sync_.get()), GL_SYNC_FLUSH_COMMANDS_BIT, kNanoseconds);
    sync_.reset();
    if (result != GL_ALREADY_SIGNALED && result != GL_CONDITION_SATISFIED)
        throw Error(ErrorKind::Internal, "the device does not answer");
}

void checkGl(const std::string& doing, const char* remedy) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) { // later ones follow from the first
    }
    if (error == GL_OUT_OF_MEMORY)
        throw Error(ErrorKind::LimitExceeded,
                    fmt::format("{}: the device has not enough memory; {}", doing, remedy));
    throw Error(ErrorKind::Internal, fmt::format("{}: GL error 0x{:04x}", doing, error));
}

GlBuffer createBuffer(std::span<const std::byte> bytes) {
    GlBuffer buffer =
        createEmptyBuffer(bytes.size() + kReadableBeyond, GL_DYNAMIC_STORAGE_BIT, kSmallerAtlas);
    glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    checkGl(fmt::format("uploading a buffer of {} bytes", bytes.size()));
    return buffer;
}

GlBuffer createOutputBuffer(std::uint64_t size, const char* remedy) {
    return createEmptyBuffer(size, 0, remedy);
}
GlBuffer createDynamicBuffer(std::uint64_t size, const char* remedy) {
    return createEmptyBuffer(size, GL_DYNAMIC_STORAGE_BIT, remedy);
}

StagingBuffer createStagingBuffer(std::uint64_t size) {
    constexpr GLbitfield kMapping = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    StagingBuffer staging;
    staging.buffer = createEmptyBuffer(size, kMapping | GL_CLIENT_STORAGE_BIT, "close what else uses it");
    staging.mapped = static_cast<std::byte*>(
        glMapNamedBufferRange(staging.buffer.name(), 0, static_cast<GLsizeiptr>(size), kMapping));
    checkGl(fmt::format("mapping a buffer of {} bytes", size));
    return staging;
}

void updateBuffer(const GlBuffer& buffer, std::span<const std::byte> bytes) {
    glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    checkGl("changing a buffer");
}

void readBuffer(const GlBuffer& buffer, std::span<std::byte> bytes) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    checkGl("reading a buffer back");
}

GlTexture createTexture2D(GlEnum format, unsigned width, unsigned height) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    GlTexture texture(name);
    glTextureStorage2D(name, 1, format, toSize(width), toSize(height));
    filterByNearest(name);
    checkGl(fmt::format("making a picture of {}x{}", width, height), "lower --size");
    return texture;
}

GlTexture createTexture3D(GlEnum target, GlEnum format, unsigned width, unsigned height, unsigned depth) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    GlTexture texture(name);
    glTextureStorage3D(name, 1, format, toSize(width), toSize(height), toSize(depth));
    filterByNearest(name);
    checkGl(fmt::format("making a texture of {}x{}x{}", width, height, depth));
    return texture;
}

GlTexture createView(const GlTexture& texture, GlEnum target, GlEnum format, unsigned layers) {
    GLuint name = 0;
    glGenTextures(1, &name);
    GlTexture view(name);
    glTextureView(name, target, texture.name(), format, 0, 1, 0, layers);
    filterByNearest(name);
    checkGl("making a view of a texture");
    return view;
}

void readTexels(const GlTexture& texture, const glm::uvec4& region, GlEnum format, GlEnum type,
                std::span<std::byte> texels) {
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    const std::size_t rowBytes = texels.size() / (region.w - region.y);
    const auto most = static_cast<unsigned>(std::max<std::size_t>(kTransferBytes / rowBytes, 1));
    for (unsigned y = region.y; y < region.w; y += most) {
        const unsigned rows = std::min(most, region.w - y);
        glGetTextureSubImage(texture.name(), 0, toSize(region.x), toSize(y), 0, toSize(region.z - region.x),
                             toSize(rows), 1, format, type, static_cast<GLsizei>(rows * rowBytes),
                             texels.data() + (y - region.y) * rowBytes);
    }
    checkGl("reading a texture back");
}

void writeTexels(const GlTexture& texture, const glm::uvec4& region, GlEnum format, GlEnum type,
                 std::span<const std::byte> texels) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    const std::size_t rowBytes = texels.size() / (region.w - region.y);
    const auto most = static_cast<unsigned>(std::max<std::size_t>(kTransferBytes / rowBytes, 1));
    for (unsigned y = region.y; y < region.w; y += most)
        glTextureSubImage2D(texture.name(), 0, toSize(region.x), toSize(y), toSize(region.z - region.x),
                            toSize(std::min(most, region.w - y)), format, type,
                            texels.data() + (y - region.y) * rowBytes);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    checkGl("writing a texture");
}

CompilingProgram::CompilingProgram(ShaderText source, const ShaderCache* cache)
    : CompilingProgram(std::vector<StageText>{{GL_COMPUTE_SHADER, std::move(source)}}, cache) {}

// No status is asked for here: that would wait for the compiler.
CompilingProgram::CompilingProgram(std::vector<StageText> stages, const ShaderCache* cache)
    : stages_(std::move(stages)), cache_(cache), program_(cache ? cache->load(wholeText()) : GlProgram()),
      fromCache_(program_.name() != 0) {
    if (fromCache_) return;
    program_ = GlProgram(glCreateProgram());
    for (const StageText& stage : stages_) {
        const GlShader& shader = shaders_.emplace_back(glCreateShader(stage.stage));
        const char* const text = stage.source.text.c_str();
        glShaderSource(shader.name(), 1, &text, nullptr);
        glCompileShader(shader.name());
        glAttachShader(program_.name(), shader.name());
    }
    if (cache) glProgramParameteri(program_.name(), GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
    glLinkProgram(program_.name());
}

std::string CompilingProgram::wholeText() const {
    std::string text;
    for (const StageText& stage : stages_) text += stage.source.text;
    return text;
}

GlProgram CompilingProgram::finish() {
    if (fromCache_) return std::move(program_);
    const auto fail = [](const StageText& stage, const char* what, const std::string& log) {
        const std::vector<std::string>& files = stage.source.files;
        throw Error(ErrorKind::Internal,
                    fmt::format("{} does not {}: {}", files.size() > 1 ? files[1] : "shader", what,
                                nameFiles(log, stage.source)));
    };
    GLint ok = GL_FALSE;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        const GLuint shader = shaders_[i].name();
        glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
        if (!ok) fail(stages_[i], "compile", logOf(shader, glGetShaderiv, glGetShaderInfoLog));
    }
    glGetProgramiv(program_.name(), GL_LINK_STATUS, &ok);
    if (!ok) fail(stages_.back(), "link", logOf(program_.name(), glGetProgramiv, glGetProgramInfoLog));
    for (const GlShader& shader : shaders_) glDetachShader(program_.name(), shader.name());
    checkGl("compiling shaders");
    if (cache_) cache_->store(wholeText(), program_);
    return std::move(program_);
}

GlProgram compileComputeProgram(const ShaderText& source) {
    return CompilingProgram(source).finish();
}

} // namespace rt
