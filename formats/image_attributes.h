#pragma once

namespace rt {

/// Names of the attributes of rt-trace's EXR files that more than one place writes or reads; see
/// tools/rt-trace/README.md. kRecipeKey and those of a ShardRecord stand with what they hold.
inline constexpr const char* kWorldToCameraKey = "worldToCamera";
inline constexpr const char* kWorldToNdcKey = "worldToNDC";
inline constexpr const char* kSoftwareKey = "software";
inline constexpr const char* kSamplesKey = "samplesPerPixel"; ///< of the pixel that has most
inline constexpr const char* kRenderSecondsKey = "renderTimeSeconds";
inline constexpr const char* kSceneHashKey = "rt:sceneHash";
inline constexpr const char* kAtlasHashKey = "rt:atlasHash";
inline constexpr const char* kRendererKey = "rt:glRenderer";
inline constexpr const char* kSeedKey = "rt:seed";
/// Of a shard: the text of the recipe that the whole picture has, by which --if-changed knows a merged one.
inline constexpr const char* kWholeRecipeKey = "rt:wholeRecipe";

} // namespace rt
