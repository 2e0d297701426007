#pragma once
#include "common/stage_timer.h"
#include "formats/atlas_file.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/options.h"
#include "tools/rt-trace/shader_cache.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/upload_atlas.h"

#include <functional>
#include <memory>

namespace rt {

/// An atlas on the device, and the shader that traces it.
struct GpuScene {
    AtlasFile file{};
    std::unique_ptr<GlContext> context; // outlives what follows
    ResourcePlan plan;                  ///< of `programs`
    GpuAtlas atlas;
    GpuPrograms programs;
    std::optional<ShaderCache> cache;
    bool programsFromCache = false;
    std::uint64_t mostSamples = 0; ///< that a picture may have on their way, see GpuView
    std::uint64_t memoryBytes = 0; ///< of the device, for the atlas and what comes beside it

    const ShaderCache* shaderCache() const { return cache ? &*cache : nullptr; }
};

/// What a picture, or a set of rays, wants of an atlas.
struct SceneNeeds {
    SceneFeatures features; ///< countWork: room for a variant that counts, beside the one that does not
    unsigned lightCount = 0;
    std::vector<MemoryNeed> memory; ///< beside the atlas
    std::uint64_t samples = 0;      ///< of a picture, see samplesToTrace()
};
/// Is given an atlas of which only the sizes are validated.
using ChooseNeeds = std::function<SceneNeeds(const Atlas& atlas, const GlLimits& limits)>;

/// Opens the device, uploads the atlas and compiles for it, while other threads verify the file. Returns once
/// all of that is done. An Error of the file comes out whatever else has gone wrong.
/// Stages: load (beside the others), context, plan, compile, upload, and wait (for the rest of load).
GpuScene loadScene(const TraceOptions& options, ShaderKind kind, const ChooseNeeds& choose,
                   StageTimer& stages);

/// Throws Error{LimitExceeded} if `cutShort`, the number of `what` ("rays", "pixels") that say kWalkCutShort,
/// is not 0.
void requireWholeWalks(std::size_t cutShort, const char* what, const std::string& name);

} // namespace rt
