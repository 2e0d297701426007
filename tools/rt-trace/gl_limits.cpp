#include "tools/rt-trace/gl_limits.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <limits>

namespace rt {
namespace {

unsigned get(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value > 0 ? static_cast<unsigned>(value) : 0;
}

std::uint64_t getWide(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return value > 0 ? static_cast<std::uint64_t>(value) : 0;
}

unsigned getIndexed(GLenum name, GLuint index) {
    GLint value = 0;
    glGetIntegeri_v(name, index, &value);
    return value > 0 ? static_cast<unsigned>(value) : 0;
}

bool hasSubgroups() {
    if (!epoxy_has_gl_extension("GL_KHR_shader_subgroup")) return false;
    const unsigned wanted = GL_SUBGROUP_FEATURE_BASIC_BIT_KHR | GL_SUBGROUP_FEATURE_BALLOT_BIT_KHR;
    return (get(GL_SUBGROUP_SUPPORTED_FEATURES_KHR) & wanted) == wanted &&
           (get(GL_SUBGROUP_SUPPORTED_STAGES_KHR) & GL_COMPUTE_SHADER_BIT) != 0;
}

} // namespace

GlLimits queryGlLimits(bool software) {
    GlLimits limits;
    ResourceLimits& resources = limits.resources;
    resources.storageBlockBytes = getWide(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    resources.storageBlocks =
        std::min(get(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS), get(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS));
    resources.storageBindings = get(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS);
    resources.textureSize3D = get(GL_MAX_3D_TEXTURE_SIZE);
    // llvmpipe refuses textures above 1 GiB (Mesa's LP_MAX_TEXTURE_SIZE).
    resources.textureBytes = software ? (1u << 30) - 1u : std::numeric_limits<std::uint64_t>::max();
    resources.textureUnits = get(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS);
    limits.fragmentResources = resources;
    limits.fragmentResources.storageBlocks =
        std::min(get(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS), get(GL_MAX_COMBINED_SHADER_STORAGE_BLOCKS));
    limits.fragmentResources.textureUnits = get(GL_MAX_TEXTURE_IMAGE_UNITS);
    limits.textureSize2D = get(GL_MAX_TEXTURE_SIZE);
    limits.arrayLayers = get(GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits.groupCountX = getIndexed(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0);
    limits.groupCountY = getIndexed(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 1);
    limits.programBinaries = get(GL_NUM_PROGRAM_BINARY_FORMATS) > 0;
    limits.shaderClock = epoxy_has_gl_extension("GL_ARB_shader_clock");
    limits.subgroups = !software && hasSubgroups();
    return limits;
}

} // namespace rt
