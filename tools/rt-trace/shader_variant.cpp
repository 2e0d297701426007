#include "tools/rt-trace/shader_variant.h"

#include <epoxy/gl.h>
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
    if (intersect) programs.intersect = intersect->finish();
    if (shade) programs.shade = shade->finish();
    return programs;
}

bool CompilingPrograms::areFromCache() const {
    const auto isCached = [](const auto& program) { return !program || program->isFromCache(); };
    return trace.isFromCache() && isCached(intersect) && isCached(shade);
}

CompilingPrograms startVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    const auto start = [&](const char* entry) {
        return CompilingProgram(variantText(plan, entry, embeddedShader), cache);
    };
    const auto startPass = [&](const char* entry) {
        const ShaderText all = variantText(plan, "shaders/pass.vert.glsl", embeddedShader);
        return CompilingProgram(
            std::vector<StageText>{{GL_VERTEX_SHADER, all},
                                   {GL_FRAGMENT_SHADER, variantText(plan, entry, embeddedShader)}},
            cache);
    };
    if (plan.features.multipass)
        return {startPass("shaders/pass_traverse.frag.glsl"), startPass("shaders/pass_intersect.frag.glsl"),
                startPass("shaders/pass_shade.frag.glsl")};
    if (plan.kind == ShaderKind::Render)
        return {start("shaders/trace.comp.glsl"), {}, start("shaders/shade.comp.glsl")};
    const bool scattered = plan.features.scatteredRays != 0;
    return {start(scattered ? "shaders/query_scattered.comp.glsl" : "shaders/query.comp.glsl"), {}};
}

GpuPrograms compileVariant(const ResourcePlan& plan, const ShaderCache* cache) {
    return startVariant(plan, cache).finish();
}

} // namespace rt
