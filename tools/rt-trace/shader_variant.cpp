#include "tools/rt-trace/shader_variant.h"

#include <fmt/format.h>

namespace rt {
namespace {

constexpr const char* kSubgroupExtensions = "#extension GL_KHR_shader_subgroup_basic : require\n"
                                            "#extension GL_KHR_shader_subgroup_ballot : require\n";

constexpr const char* kClockExtension = "#extension GL_ARB_shader_clock : require\n";

} // namespace

ShaderText variantText(const ResourcePlan& plan, const std::string& entry, const ShaderFinder& find) {
    const bool render = plan.kind == ShaderKind::Render;
    const std::string prelude = fmt::format(
        "#version 450 core\n{}{}{}#define RT_GROUP_X {}\n#define RT_GROUP_Y {}\n",
        plan.features.subgroups ? kSubgroupExtensions : "", plan.features.hasTime ? kClockExtension : "",
        featureDefines(plan.features), render ? kGroupSide : kRaysPerGroup, render ? kGroupSide : 1);
    const auto findWithResources = [&](std::string_view path) -> std::optional<std::string> {
        if (path == "shaders/resources.glsl") return resourceText(plan);
        return find(path);
    };
    return composeShader(prelude, entry, findWithResources);
}

ShaderText variantText(const ResourcePlan& plan) {
    const char* const entry = plan.kind == ShaderKind::Render ? "shaders/render.comp.glsl"
                              : plan.features.scatteredRays   ? "shaders/query_scattered.comp.glsl"
                                                              : "shaders/query.comp.glsl";
    return variantText(plan, entry, embeddedShader);
}

CompilingProgram startVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    return CompilingProgram(variantText(plan), cache);
}

GlProgram compileVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    return startVariant(plan, cache).finish();
}

} // namespace rt
