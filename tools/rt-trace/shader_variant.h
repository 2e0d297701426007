#pragma once
#include "tools/rt-trace/gl_objects.h"
#include "tools/rt-trace/shader_resources.h"

#include <optional>

namespace rt {

inline constexpr unsigned kRaysPerGroup = 128;

/// An entry shader that `find` knows, for the plan's features.
ShaderText variantText(const ResourcePlan& plan, const std::string& entry, const ShaderFinder& find);

/// The programs of one kind of work.
struct GpuPrograms {
    GlProgram trace;     ///< rays of a query, or of a round of samples; of RayPasses: their steps
    GlProgram intersect; ///< only of RayPasses: triangle tests between the steps
    GlProgram shade;     ///< what samples' rays have met; only of a picture
};
/// They may go on being compiled while other commands follow.
struct CompilingPrograms {
    CompilingProgram trace;
    std::optional<CompilingProgram> intersect = {}, shade = {};
    bool areFromCache() const;
    /// As CompilingProgram::finish().
    GpuPrograms finish();
};
/// Starts to compile what the plan's kind and features want, or finds it in the cache.
CompilingPrograms startVariant(const ResourcePlan& plan, const ShaderCache* cache = nullptr);
/// Throws as compileComputeProgram() does.
GpuPrograms compileVariant(const ResourcePlan& plan, const ShaderCache* cache = nullptr);

} // namespace rt
