#pragma once
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/ray_query.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/upload_atlas.h"

#include <gtest/gtest.h>

#include <memory>

namespace rt::test {

/// One GL context for all tests of a suite: the device that rt-trace itself would take.
class OnGpu : public testing::Test {
protected:
    static void SetUpTestSuite() {
        prepareGlEnvironment(0);
        context = GlContext::open("auto");
    }
    static void TearDownTestSuite() { context.reset(); }
    static inline std::unique_ptr<GlContext> context;

    static const GlLimits& limits() { return context->limits(); }
};

inline Atlas makeAtlas(const Mesh& mesh, std::uint32_t structure, glm::uvec3 dims) {
    BuildOptions options;
    options.structure = structure;
    options.resolution.exact = dims;
    StageTimer timer;
    return buildAtlas({mesh, 0}, "mesh", options, timer).atlas;
}

struct QuerySettings {
    bool anyHit = false;
    std::optional<ResourceLimits> limits; ///< the device's if absent
    std::uint64_t maxBatch = ~std::uint64_t(0);
    std::size_t pieceBytes = UploadRing::kPieceBytes;
    unsigned intersect = kIntersectWatertight;
};

/// `Record` says which precision: QueryHit or QueryHitDouble.
template <class Record>
std::vector<Record> traceVariant(const GlContext& context, const Atlas& atlas,
                                 const std::vector<QueryRay>& rays, const QuerySettings& settings,
                                 bool scattered) {
    const ResourceLimits limits = settings.limits.value_or(context.limits().resources);
    SceneFeatures features = queryFeatures(atlas, settings.anyHit);
    features.doublePrecision = std::is_same_v<Record, QueryHitDouble>;
    features.intersect = settings.intersect;
    features.scatteredRays = scattered;
    features.cutLoops = context.device().software;
    features.subgroups = scattered && context.limits().subgroups;
    const ResourcePlan plan = planResources(atlas, features, ShaderKind::Query, limits, "atlas");
    const GpuAtlas gpuAtlas = uploadAtlas(atlas, plan, context.limits(), 0, "atlas", settings.pieceBytes);
    const std::optional<unsigned> several = features.subgroups ? std::nullopt : std::optional(3u);
    GpuRays gpuRays(rays.size(), features, context.limits(), settings.maxBatch, several);
    const GlProgram program = compileVariant(plan);
    gpuAtlas.bind();
    if (scattered) { // other hits, so that none of those wanted can be left over from before
        std::vector<QueryRay> backwards(rays.rbegin(), rays.rend());
        backwards.resize(std::min<std::size_t>(rays.size(), gpuRays.batchSize()));
        gpuRays.upload(backwards);
        gpuRays.trace(program, 1, context.device().software);
    }
    std::vector<Record> hits(rays.size());
    for (std::size_t first = 0; first < rays.size(); first += gpuRays.batchSize()) {
        const std::size_t count = std::min<std::size_t>(gpuRays.batchSize(), rays.size() - first);
        gpuRays.upload(std::span(rays).subspan(first, count));
        gpuRays.trace(program, 1, context.device().software);
        gpuRays.readHits(std::as_writable_bytes(std::span(hits).subspan(first, count)));
    }
    return hits;
}

/// Traced as scattered rays and as coherent ones, which must be the same to the bit.
inline std::vector<QueryHit> traceQuery(const GlContext& context, const Atlas& atlas,
                                        const std::vector<QueryRay>& rays,
                                        const QuerySettings& settings = {}) {
    const std::vector<QueryHit> hits = traceVariant<QueryHit>(context, atlas, rays, settings, false);
    const std::vector<QueryHit> scattered = traceVariant<QueryHit>(context, atlas, rays, settings, true);
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (hits[i].tuvId != scattered[i].tuvId) {
            ADD_FAILURE() << "ray " << i << ": other hits where rays are traced as scattered ones";
            break;
        }
    return hits;
}

/// The reference: coherent, in double precision.
inline std::vector<QueryHitDouble> traceDouble(const GlContext& context, const Atlas& atlas,
                                               const std::vector<QueryRay>& rays,
                                               const QuerySettings& settings = {}) {
    return traceVariant<QueryHitDouble>(context, atlas, rays, settings, false);
}

} // namespace rt::test
