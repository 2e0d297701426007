#pragma once
#include "formats/atlas.h"
#include "formats/gpu_interface.shared.h"

#include <span>
#include <string>

namespace rt {

/// What a shader variant is compiled for; shaders/features.glsl turns each field's macro into a constant.
struct SceneFeatures {
    unsigned structure = kStructureUniform;
    unsigned doublePrecision = 0;
    unsigned intersect = kIntersectWatertight;
    unsigned anyHit = 0;
    unsigned scatteredRays = 0;
    unsigned subgroups = 0;
    unsigned software = 0;
    unsigned countWork = 0;
    unsigned hasSlivers = 0;
    unsigned hasTextures = 0;
    unsigned hasReflection = 0;
    unsigned hasTransmission = 0;
    unsigned hasEmission = 0;
    unsigned hasLights = 0;
    unsigned maxDepth = 0;
};

/// One row per feature: the only place that knows which macro carries which field, and why it would be on.
struct FeatureRow {
    const char* macro;
    unsigned SceneFeatures::*field;
    const char* reason; ///< what makes it differ from 0
};
std::span<const FeatureRow> featureTable();

/// Features of a picture. A material counts only if a triangle uses it; with `maxDepth` 0, surfaces neither
/// reflect nor transmit. Safe for an atlas of which only the sizes are validated.
SceneFeatures renderFeatures(const Atlas& atlas, unsigned maxDepth, std::size_t lightCount);

/// Features of ray queries, which do not shade.
SceneFeatures queryFeatures(const Atlas& atlas, bool anyHit);

/// One #define line per row of the table.
std::string featureDefines(const SceneFeatures& features);

} // namespace rt
