#include "tools/rt-trace/ray_passes.h"

#include "common/error.h"
#include "formats/gpu_interface.shared.h"

#include <epoxy/gl.h>

#include <initializer_list>
#include <vector>

namespace rt {
namespace {

constexpr unsigned kIterationsInGroup = 8; // before the host asks whether there are rays left
constexpr std::uint64_t kTexelBytes = 16;
constexpr std::uint64_t kDepthBytes = 4;

GlFramebuffer createTargets(const std::array<GlTexture, kRayTextureCount>& textures, const GlTexture& depth,
                            std::initializer_list<unsigned> units) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    GlFramebuffer framebuffer(name);
    std::vector<GLenum> attachments;
    for (const unsigned unit : units) {
        attachments.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachments.size()));
        glNamedFramebufferTexture(name, attachments.back(), textures[unit - RT_TEXTURE_FIRST_RAYS].name(), 0);
    }
    glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth.name(), 0);
    glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(attachments.size()), attachments.data());
    if (glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorKind::NoGpu, "the device cannot render into textures of four 32-bit integers, as "
                                      "--kernel multipass does; use --kernel compute");
    return framebuffer;
}

GlVertexArray createVertexArray() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    return GlVertexArray(name);
}

GlQuery createAnySamplesQuery() {
    GLuint name = 0;
    glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &name);
    return GlQuery(name);
}

// One pass over the viewport, at the pixels where `depth` and what is there compare so. What it writes can be
// read by the next one, at the same pixel.
void draw(const GlProgram& program, const GlFramebuffer& targets, GlEnum comparison, float depth,
          bool isDepthWritten) {
    glUseProgram(program.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.name());
    glDepthFunc(comparison);
    glDepthMask(isDepthWritten ? GL_TRUE : GL_FALSE);
    glDepthRangef(depth, 1.0f);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glTextureBarrier();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

} // namespace

RayPasses::RayPasses(glm::uvec2 size) {
    for (GlTexture& texture : textures_) texture = createTexture2D(GL_RGBA32UI, size.x, size.y);
    depth_ = createTexture2D(GL_DEPTH_COMPONENT32F, size.x, size.y);
    intersectTarget_ = createTargets(textures_, depth_, {RT_TEXTURE_HIT});
    traverseTarget_ = createTargets(textures_, depth_, {RT_TEXTURE_PROGRESS});
    shadeTargets_ = createTargets(
        textures_, depth_, {RT_TEXTURE_COLOR, RT_TEXTURE_ORIGIN, RT_TEXTURE_DIRECTION, RT_TEXTURE_PROGRESS});
    noVertices_ = createVertexArray();
    anyRay_ = createAnySamplesQuery();
    checkGl("making the textures of the rays", "lower --size or use --crop");
}

std::uint64_t RayPasses::bytesFor(glm::uvec2 size) {
    return std::uint64_t(size.x) * size.y * (kTexelBytes * kRayTextureCount + kDepthBytes);
}

void RayPasses::bind() const {
    for (unsigned i = 0; i < kRayTextureCount; ++i)
        glBindTextureUnit(RT_TEXTURE_FIRST_RAYS + i, textures_[i].name());
    glBindVertexArray(noVertices_.name());
    checkGl("binding the rays");
}

void RayPasses::intersect(const GpuPrograms& programs, StageTimes* times) {
    timed(times ? &times->intersectMs : nullptr,
          [&] { draw(programs.intersect, intersectTarget_, GL_LESS, kDepthOfIntersect, false); });
    ++counts_.intersect;
}

void RayPasses::traverse(const GpuPrograms& programs, StageTimes* times) {
    timed(times ? &times->traceMs : nullptr,
          [&] { draw(programs.trace, traverseTarget_, GL_ALWAYS, 0.0f, true); });
    ++counts_.traverse;
}

void RayPasses::shade(const GpuPrograms& programs, unsigned stage, StageTimes* times) {
    glProgramUniform1ui(programs.shade.name(), RT_LOCATION_STAGE, stage);
    timed(times ? &times->shadeMs : nullptr, [&] {
        draw(programs.shade, shadeTargets_, stage == kStageAdvance ? GL_LESS : GL_ALWAYS, kDepthOfShade,
             true);
    });
    ++counts_.shade;
}

// One of each pass. Returns whether there was a ray, but waits for that only if it is wanted.
bool RayPasses::iterate(const GpuPrograms& programs, StageTimes* times, bool isAsked) {
    intersect(programs, times);
    if (isAsked) glBeginQuery(GL_ANY_SAMPLES_PASSED, anyRay_.name());
    traverse(programs, times);
    if (isAsked) glEndQuery(GL_ANY_SAMPLES_PASSED);
    shade(programs, kStageAdvance, times);
    GLuint any = GL_TRUE;
    if (isAsked) glGetQueryObjectuiv(anyRay_.name(), GL_QUERY_RESULT, &any);
    return any != GL_FALSE;
}

void RayPasses::render(const GpuPrograms& programs, const glm::uvec4& region, StageTimes* times) {
    glViewport(static_cast<GLint>(region.x), static_cast<GLint>(region.y),
               static_cast<GLsizei>(region.z - region.x), static_cast<GLsizei>(region.w - region.y));
    glEnable(GL_DEPTH_TEST);
    shade(programs, kStageBegin, times);
    for (unsigned i = 1; iterate(programs, times, i % kIterationsInGroup == 0); ++i) {
    }
    shade(programs, kStageResolve, times);
    glDisable(GL_DEPTH_TEST);
}

void RayPasses::warmUp(const GpuPrograms& programs) {
    const PassCounts before = counts_;
    render(programs, glm::uvec4(0), nullptr);
    counts_ = before;
}

} // namespace rt
