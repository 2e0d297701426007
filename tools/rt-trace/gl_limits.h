#pragma once
#include "tools/rt-trace/shader_resources.h"

namespace rt {

/// What the current GL context allows.
struct GlLimits {
    ResourceLimits resources;         ///< of compute shaders
    ResourceLimits fragmentResources; ///< of fragment shaders
    unsigned textureSize2D = 0;
    unsigned arrayLayers = 0;
    unsigned groupCountX = 0; ///< work groups of one dispatch
    unsigned groupCountY = 0;
    bool programBinaries = false; ///< the driver gives compiled shaders out and takes them back
    bool shaderClock = false;     ///< shaders may read the device's clock (GL_ARB_shader_clock)
    bool subgroups = false; ///< compute shaders may count votes (GL_KHR_shader_subgroup); no software does
};

/// Asks the current context. `software`: it is one of Mesa's software renderers, whose textures have a limit
/// in bytes that GL has no name for.
GlLimits queryGlLimits(bool software);

} // namespace rt
