#pragma once
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/shader_resources.h"

namespace rt {

// Work groups: a square of pixels, or a run of rays.
inline constexpr unsigned kGroupSide = 8;
inline constexpr unsigned kRaysPerGroup = 128;

/// The entry shader of the plan's kind, shaders/render.comp.glsl or shaders/query.comp.glsl, for its
/// features.
ShaderText variantText(const ResourcePlan& plan);
/// As variantText() with an entry shader that `find` knows.
ShaderText variantText(const ResourcePlan& plan, const std::string& entry, const ShaderFinder& find);

/// Starts to compile variantText(plan), or finds it in the cache.
CompilingProgram startVariant(const ResourcePlan& plan, const ShaderCache* cache = nullptr);
/// Compiles variantText(plan). Throws as compileComputeProgram() does.
GlProgram compileVariant(const ResourcePlan& plan, const ShaderCache* cache = nullptr);

} // namespace rt
