#include "tools/rt-trace/explain.h"

#include <fmt/format.h>

#include <algorithm>

namespace rt {
namespace {

bool isPaged(const ResourcePlan& plan, const std::string& name) {
    return std::any_of(plan.arrays.begin(), plan.arrays.end(),
                       [&](const PagedArray& array) { return name == array.name; });
}

std::string total(const std::vector<SectionUse>& uses, bool uploaded) {
    std::uint64_t bytes = 0;
    for (const SectionUse& use : uses)
        if (use.uploaded == uploaded) bytes += use.bytes;
    return fmt::format("{} bytes {}", bytes, uploaded ? "uploaded" : "skipped");
}

} // namespace

std::vector<SectionUse> sectionUses(const Atlas& atlas, const ResourcePlan& plan, bool ownEnvironment) {
    const bool render = plan.kind == ShaderKind::Render;
    const bool images = render && plan.features.hasTextures;
    std::vector<SectionUse> uses = {{"voxels", atlas.voxels.size_bytes(), true}};
    const auto addPaged = [&](const char* name, std::uint64_t bytes) {
        uses.push_back({name, bytes, isPaged(plan, name)});
    };
    addPaged("bricks", atlas.bricks.size_bytes());
    addPaged("references", atlas.references.size_bytes());
    addPaged("triangles", atlas.triangles.size_bytes());
    addPaged("triangleVertices", atlas.triangleVertices.size_bytes());
    addPaged("normals", atlas.normals.size_bytes());
    addPaged("texcoords", atlas.texcoords.size_bytes());
    uses.push_back({"materials", atlas.materials.size_bytes(), render});
    uses.push_back({"lights", atlas.lights.size_bytes(), render && plan.features.lightCount > 0});
    uses.push_back({"images", atlas.images.size_bytes(), images});
    uses.push_back({"pages", atlas.pages.size_bytes(), images});
    uses.push_back(
        {"environment", atlas.environment.size_bytes(), plan.features.hasEnvironment && ownEnvironment});
    std::erase_if(uses, [](const SectionUse& use) { return use.bytes == 0; });
    return uses;
}

std::string explanation(const Atlas& atlas, const ResourcePlan& plan, bool ownEnvironment) {
    std::string text = "What the shader is compiled for; 0 leaves code out, other values come from:\n";
    for (const FeatureRow& row : featureTable())
        text += fmt::format("  {:<24}{:>3}  {}\n", row.macro, plan.features.*row.field, row.reason);
    const std::vector<SectionUse> uses = sectionUses(atlas, plan, ownEnvironment);
    text += "Parts of the atlas:\n";
    for (const SectionUse& use : uses)
        text += fmt::format("  {:<18}{:>14} bytes  {}\n", use.name, use.bytes,
                            use.uploaded ? "uploaded" : "skipped: no feature reads it");
    return text + fmt::format("  {}, {}\n", total(uses, true), total(uses, false));
}

} // namespace rt
