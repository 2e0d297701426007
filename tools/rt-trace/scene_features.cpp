#include "tools/rt-trace/scene_features.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <vector>

namespace rt {

std::span<const FeatureRow> featureTable() {
    static constexpr FeatureRow kTable[] = {
        {"RT_STRUCTURE", &SceneFeatures::structure, "the atlas' structure kind"},
        {"RT_DOUBLE", &SceneFeatures::doublePrecision, "--precision double was asked for"},
        {"RT_INTERSECT", &SceneFeatures::intersect, "--intersect asked for another test than watertight"},
        {"RT_ANY_HIT", &SceneFeatures::anyHit, "--any-hit was asked for"},
        {"RT_SCATTERED_RAYS", &SceneFeatures::scatteredRays,
         "neighbours among the rays go different ways, or --ray-order says so"},
        {"RT_SUBGROUPS", &SceneFeatures::subgroups,
         "the device says which invocations run side by side, and scattered rays want to know"},
        {"RT_SOFTWARE", &SceneFeatures::software,
         "the device is software: loops end after 65,535 rounds, and fma() is two roundings"},
        {"RT_MULTIPASS", &SceneFeatures::multipass, "--kernel multipass was given"},
        {"RT_COUNT_WORK", &SceneFeatures::countWork, "--stats was asked for"},
        {"RT_HAS_SLIVERS", &SceneFeatures::hasSlivers, "the atlas marks triangles as slivers"},
        {"RT_HAS_TEXTURES", &SceneFeatures::hasTextures, "a material in use has an image"},
        {"RT_HAS_NORMAL_IMAGES", &SceneFeatures::hasNormalImages, "a material in use has a normal image"},
        {"RT_HAS_CUTOUTS", &SceneFeatures::hasCutouts, "a material in use is cut out by its opacity"},
        {"RT_HAS_OPACITY", &SceneFeatures::hasOpacity, "a material in use stops part of the light only"},
        {"RT_HAS_REFLECTION", &SceneFeatures::hasReflection, "a material in use reflects"},
        {"RT_HAS_ROUGHNESS", &SceneFeatures::hasRoughness, "one that reflects or transmits is rough"},
        {"RT_HAS_TRANSMISSION", &SceneFeatures::hasTransmission, "a material in use transmits"},
        {"RT_HAS_ATTENUATION", &SceneFeatures::hasAttenuation,
         "one that transmits takes colour out of light"},
        {"RT_HAS_EMISSION", &SceneFeatures::hasEmission, "a material in use emits, or is unlit"},
        {"RT_LIGHT_COUNT", &SceneFeatures::lightCount, "how many lights: none, one, or more (2)"},
        {"RT_LIGHT_KINDS", &SceneFeatures::lightKinds, "bits of the kinds of lights that there are"},
        {"RT_HAS_ENVIRONMENT", &SceneFeatures::hasEnvironment,
         "--environment was given, or the scene has one"},
        {"RT_HAS_OCCLUSION", &SceneFeatures::hasOcclusion, "--occlusion was given"},
        {"RT_VIEW", &SceneFeatures::view, "perspective, orthographic (1) or panorama (2)"},
        {"RT_HAS_LENS", &SceneFeatures::hasLens, "the camera has a lens"},
        {"RT_MULTISAMPLE", &SceneFeatures::multisample, "more than one sample per pixel"},
        {"RT_HAS_AOVS", &SceneFeatures::hasAovs, "channels beyond colour, N, Z and id were asked for"},
        {"RT_HAS_TIME", &SceneFeatures::hasTime,
         "the device's time was asked for, --heat time or --aov time"},
        {"RT_HAS_MOMENTS", &SceneFeatures::hasMoments, "the error is estimated"},
        {"RT_MAX_DEPTH", &SceneFeatures::maxDepth,
         "--max-depth, where a material in use reflects, transmits or stops part of the light only"},
    };
    return kTable;
}

namespace {

bool hasSlivers(std::span<const TriangleRecord> triangles) {
    using Range = tbb::blocked_range<std::size_t>;
    const auto anyIn = [&](const Range& range, bool found) {
        return found || std::any_of(&triangles[range.begin()], &triangles[range.begin()] + range.size(),
                                    [](const TriangleRecord& t) { return t.v1.w != 0.0f; });
    };
    return tbb::parallel_reduce(Range(0, triangles.size(), 1u << 14), false, anyIn, std::logical_or<>());
}

std::vector<Material> materialsInUse(const Atlas& atlas) {
    std::vector<bool> used(atlas.materials.size());
    for (const glm::uvec4& triangle : atlas.triangleVertices)
        if (triangle.w < used.size()) used[triangle.w] = true; // the check of the file may still be running
    std::vector<Material> materials;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) materials.push_back(atlas.materials[i]);
    return materials;
}

void addMaterial(const Material& m, const PictureNeeds& needs, SceneFeatures& features) {
    features.hasTextures |= m.images != glm::uvec4(kNoImage) || m.more.x != kNoImage;
    features.hasNormalImages |= m.images.z != kNoImage;
    features.hasEmission |=
        std::max({m.emission.x, m.emission.y, m.emission.z}) > 0.0f || (m.more.y & kMaterialUnlit) != 0;
    const bool clear = (m.more.y & kMaterialClear) != 0;
    features.hasCutouts |= clear && m.transmission.w > 0.0f;
    if (needs.maxDepth == 0) return;
    const bool reflects = m.reflection.x > 0.0f || m.reflection.z > 0.0f || m.reflection.w > 0.0f;
    const bool transmits = m.transmission.x > 0.0f;
    features.hasOpacity |= clear && m.transmission.w == 0.0f;
    features.hasReflection |= reflects;
    features.hasTransmission |= transmits;
    features.hasRoughness |= (reflects || transmits) && m.reflection.y > 0.0f;
    features.hasAttenuation |= transmits && m.transmission.z > 0.0f;
}

} // namespace

SceneFeatures renderFeatures(const Atlas& atlas, const PictureNeeds& needs) {
    SceneFeatures features;
    features.structure = atlas.grid.dims.w;
    features.hasSlivers = hasSlivers(atlas.triangles);
    for (const Material& material : materialsInUse(atlas)) addMaterial(material, needs, features);
    features.maxDepth =
        features.hasReflection || features.hasTransmission || features.hasOpacity ? needs.maxDepth : 0;
    features.lightCount = static_cast<unsigned>(std::min<std::size_t>(needs.lights.size(), kManyLights));
    for (const Light& light : needs.lights)
        features.lightKinds |= 1u << std::min(light.kind.x, kLightKindCount);
    features.hasEnvironment = needs.environment;
    features.hasOcclusion = needs.occlusion;
    features.view = needs.view;
    features.hasLens = needs.lens;
    features.multisample = needs.multisample;
    features.hasAovs = needs.aovs;
    features.hasTime = needs.time;
    features.hasMoments = needs.moments;
    features.multipass = needs.multipass;
    return features;
}

SceneFeatures queryFeatures(const Atlas& atlas, bool anyHit) {
    SceneFeatures features;
    features.structure = atlas.grid.dims.w;
    features.hasSlivers = hasSlivers(atlas.triangles);
    features.anyHit = anyHit;
    return features;
}

std::string featureDefines(const SceneFeatures& features) {
    std::string text;
    for (const FeatureRow& row : featureTable())
        text += fmt::format("#define {} {}\n", row.macro, features.*row.field);
    return text;
}

} // namespace rt
