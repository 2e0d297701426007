#pragma once
#include "tools/rt-trace/shader_source.h"

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <utility>

// Owners of GL objects of the current context; all of them must be destroyed before it is. The functions
// throw Error{LimitExceeded} when the device runs out of memory and Error{Internal} for any other GL error.

namespace rt {

using GlName = unsigned; ///< GLuint
using GlEnum = unsigned; ///< GLenum

template <void (*Delete)(GlName)>
class GlObject {
public:
    GlObject() = default;
    explicit GlObject(GlName name) : name_(name) {}
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlObject() {
        if (name_) Delete(name_);
    }
    GlName name() const { return name_; }

private:
    GlName name_ = 0;
};

void deleteBuffer(GlName name);
void deleteTexture(GlName name);
void deleteProgram(GlName name);
void deleteQuery(GlName name);
void deleteShader(GlName name);
void deleteFramebuffer(GlName name);
void deleteVertexArray(GlName name);
using GlBuffer = GlObject<deleteBuffer>;
using GlTexture = GlObject<deleteTexture>;
using GlProgram = GlObject<deleteProgram>;
using GlQuery = GlObject<deleteQuery>;
using GlShader = GlObject<deleteShader>;
using GlFramebuffer = GlObject<deleteFramebuffer>;
using GlVertexArray = GlObject<deleteVertexArray>;

/// A point in the stream of GL commands; none by default.
class GlFence {
public:
    static GlFence insert();
    /// Waits until the device has passed it, if there is one. Throws Error{Internal} if it never does.
    void wait();

private:
    struct Delete {
        void operator()(void* sync) const;
    };
    std::unique_ptr<void, Delete> sync_; // GLsync
};

inline constexpr const char* kSmallerAtlas = "lower rt-grid's --resolution";

/// Throws for the errors that GL has recorded since the last call. `doing` begins the message; `remedy` ends
/// it where the device ran out of memory.
void checkGl(const std::string& doing, const char* remedy = kSmallerAtlas);

inline constexpr std::uint64_t kReadableBeyond = 16; ///< bytes

/// A buffer that holds `bytes`; shaders may read kReadableBeyond bytes more, whatever they find there.
GlBuffer createBuffer(std::span<const std::byte> bytes);
/// A buffer of `size` bytes that only the device writes: shaders, or copies from another buffer.
GlBuffer createOutputBuffer(std::uint64_t size, const char* remedy = kSmallerAtlas);
/// A buffer of `size` bytes for updateBuffer() to change.
GlBuffer createDynamicBuffer(std::uint64_t size, const char* remedy = kSmallerAtlas);
/// A buffer near the host of which all stays mapped for writing, without flushing. What is written there must
/// not be changed before the commands that read it have passed a fence.
struct StagingBuffer {
    GlBuffer buffer;
    std::byte* mapped = nullptr; ///< as long as the buffer is there
};
StagingBuffer createStagingBuffer(std::uint64_t size);
void updateBuffer(const GlBuffer& buffer, std::span<const std::byte> bytes);
void readBuffer(const GlBuffer& buffer, std::span<std::byte> bytes);

/// Textures without mipmaps, filtered by GL_NEAREST. `format` is a sized internal format of GL. The 2D ones
/// are for pictures.
GlTexture createTexture2D(GlEnum format, unsigned width, unsigned height);
GlTexture createTexture3D(GlEnum target, GlEnum format, unsigned width, unsigned height, unsigned depth);
/// The texels of `texture`, which has so many layers, read in another format of the same size.
GlTexture createView(const GlTexture& texture, GlEnum target, GlEnum format, unsigned layers);
/// Reads `region`, [xy, zw), of a 2D texture, row by row from its y.
void readTexels(const GlTexture& texture, const glm::uvec4& region, GlEnum format, GlEnum type,
                std::span<std::byte> texels);
/// Writes what readTexels() gave.
void writeTexels(const GlTexture& texture, const glm::uvec4& region, GlEnum format, GlEnum type,
                 std::span<const std::byte> texels);

class ShaderCache;

/// Source of one stage of a program; `stage` is GL_COMPUTE_SHADER, ...
struct StageText {
    GlEnum stage;
    ShaderText source;
};

/// A program that the driver may go on compiling, on threads of its own, while other commands follow.
class CompilingProgram {
public:
    /// A compute shader. Takes it from `cache`, if there is one and it is there, and puts it there in
    /// finish() otherwise.
    explicit CompilingProgram(ShaderText source, const ShaderCache* cache = nullptr);
    explicit CompilingProgram(std::vector<StageText> stages, const ShaderCache* cache = nullptr);
    bool isFromCache() const { return fromCache_; }
    /// Waits for it; to be called once. Throws Error{Internal} with the driver's log, files named.
    GlProgram finish();

private:
    std::string wholeText() const;

    std::vector<StageText> stages_;
    const ShaderCache* cache_;
    GlProgram program_;
    bool fromCache_;
    std::vector<GlShader> shaders_; // of the stages; none of a program from the cache
};

/// Compiles and links a compute shader. Throws as CompilingProgram::finish() does.
GlProgram compileComputeProgram(const ShaderText& source);

} // namespace rt
