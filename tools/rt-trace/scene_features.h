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
    unsigned multipass = 0; ///< only of pictures, in float and without hasTime
    unsigned countWork = 0;
    unsigned hasSlivers = 0;
    unsigned hasTextures = 0;
    unsigned hasNormalImages = 0;
    unsigned hasCutouts = 0;
    unsigned hasOpacity = 0;
    unsigned hasReflection = 0;
    unsigned hasRoughness = 0;
    unsigned hasTransmission = 0;
    unsigned hasAttenuation = 0;
    unsigned hasEmission = 0;
    unsigned lightCount = 0; ///< up to kManyLights
    unsigned lightKinds = 0; ///< bit 1 << kLight... of each kind that there is
    unsigned hasEnvironment = 0;
    unsigned hasOcclusion = 0;
    unsigned view = 0; ///< kPerspectiveView, ...
    unsigned hasLens = 0;
    unsigned multisample = 0;
    unsigned hasAovs = 0;
    unsigned hasTime = 0; ///< with hasAovs only
    unsigned hasMoments = 0;
    unsigned maxDepth = 0;
};

/// From this many lights on a variant loops over however many there are.
inline constexpr unsigned kManyLights = 2;

/// One row per feature: the only place that knows which macro carries which field, and why it would be on.
struct FeatureRow {
    const char* macro;
    unsigned SceneFeatures::*field;
    const char* reason; ///< what makes it differ from 0
};
std::span<const FeatureRow> featureTable();

/// What is wanted of a picture beyond what the atlas says.
struct PictureNeeds {
    unsigned maxDepth = 4; ///< 0: surfaces neither reflect nor transmit
    std::span<const Light> lights = {};
    bool environment = false;
    bool occlusion = false; ///< surfaces hide ambient light
    unsigned view = kPerspectiveView;
    bool lens = false;
    bool multisample = false; ///< else one sample in the middle of each pixel
    bool aovs = false;
    bool time = false; ///< with aovs only
    bool moments = false;
    bool multipass = false;
};

/// Features of a picture. A material counts only if a triangle uses it. Safe for an atlas of which only the
/// sizes are validated.
SceneFeatures renderFeatures(const Atlas& atlas, const PictureNeeds& needs);

/// Features of ray queries, which do not shade.
SceneFeatures queryFeatures(const Atlas& atlas, bool anyHit);

/// One #define line per row of the table.
std::string featureDefines(const SceneFeatures& features);

} // namespace rt
