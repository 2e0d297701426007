#include "tools/rt-trace/shader_variant.h"

#include <fmt/format.h>

namespace rt {
namespace {

constexpr const char* kSubgroupExtensions = "#extension GL_KHR_shader_subgroup_basic : require\n"
                                            "#extension GL_KHR_shader_subgroup_ballot : require\n";

constexpr const char* kClockExtension = "#extension GL_ARB_shader_clock : require\n";

} // namespace

ShaderText variantText(const ResourcePlan& plan, const std::string& entry, const ShaderFinder& find) {
    const std::string prelude = fmt::format("#version 450 core\n{}{}{}#define RT_GROUP_X {}\n",
                                            plan.features.subgroups ? kSubgroupExtensions : "",
                                            plan.features.hasTime ? kClockExtension : "",
                                            featureDefines(plan.features), kRaysPerGroup);
    const auto findWithResources = [&](std::string_view path) -> std::optional<std::string> {
        if (path == "shaders/resources.glsl") return resourceText(plan);
        return find(path);
    };
    return composeShader(prelude, entry, findWithResources);
}

GpuPrograms CompilingPrograms::finish() {
    GpuPrograms programs;
    programs.trace = trace.finish();
    if (shade) programs.shade = shade->finish();
    return programs;
}

bool CompilingPrograms::areFromCache() const {
    return trace.isFromCache() && (!shade || shade->isFromCache());
}

CompilingPrograms startVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    const auto start = [&](const char* entry) {
        return CompilingProgram(variantText(plan, entry, embeddedShader), cache);
    };
    if (plan.kind == ShaderKind::Render)
        return {start("shaders/trace.comp.glsl"), start("shaders/shade.comp.glsl")};
    const bool scattered = plan.features.scatteredRays != 0;
    return {start(scattered ? "shaders/query_scattered.comp.glsl" : "shaders/query.comp.glsl"), {}};
}

GpuPrograms compileVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    return startVariant(plan, cache).finish();
}

} // namespace rt
