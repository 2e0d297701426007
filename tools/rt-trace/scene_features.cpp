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
        {"RT_COUNT_WORK", &SceneFeatures::countWork, "--stats was asked for"},
        {"RT_HAS_SLIVERS", &SceneFeatures::hasSlivers, "the atlas marks triangles as slivers"},
        {"RT_HAS_TEXTURES", &SceneFeatures::hasTextures, "a material in use has a base-colour image"},
        {"RT_HAS_REFLECTION", &SceneFeatures::hasReflection, "a material in use reflects"},
        {"RT_HAS_TRANSMISSION", &SceneFeatures::hasTransmission, "a material in use transmits"},
        {"RT_HAS_EMISSION", &SceneFeatures::hasEmission, "a material in use emits"},
        {"RT_HAS_LIGHTS", &SceneFeatures::hasLights, "there is a point light"},
        {"RT_MAX_DEPTH", &SceneFeatures::maxDepth,
         "--max-depth, where a material in use reflects or transmits"},
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

} // namespace

SceneFeatures renderFeatures(const Atlas& atlas, unsigned maxDepth, std::size_t lightCount) {
    std::vector<bool> used(atlas.materials.size());
    for (const glm::uvec4& triangle : atlas.triangleVertices)
        if (triangle.w < used.size()) used[triangle.w] = true; // the check of the file may still be running
    SceneFeatures features;
    features.structure = atlas.grid.dims.w;
    features.hasSlivers = hasSlivers(atlas.triangles);
    features.hasLights = lightCount > 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        const Material& material = atlas.materials[i];
        features.hasTextures |= material.images.x != kNoImage;
        features.hasEmission |=
            material.emission.x > 0.0f || material.emission.y > 0.0f || material.emission.z > 0.0f;
        features.hasReflection |= maxDepth > 0 && material.optics.x > 0.0f;
        features.hasTransmission |= maxDepth > 0 && material.optics.y > 0.0f;
    }
    features.maxDepth = features.hasReflection || features.hasTransmission ? maxDepth : 0;
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
