#pragma once
#include "tests/support/make_mesh.h"
#include "tools/rt-grid/build_atlas.h"
#include "tools/rt-trace/gl_context.h"
#include "tools/rt-trace/ray_query.h"
#include "tools/rt-trace/shader_variant.h"
#include "tools/rt-trace/upload_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace rt::test {

/// One GL context for all tests of a suite: the device that rt-trace itself would take.
class OnGpu : public testing::Test {
protected:
    static void SetUpTestSuite() {
        prepareGlEnvironment(0);
        context = GlContext::open({});
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

/// Programs by their text, compiled once each. To be destroyed before the context.
class ProgramCache {
public:
    const GlProgram& of(const ResourcePlan& plan) {
        GlProgram& program = programs_[featureDefines(plan.features) + resourceText(plan)];
        if (!program.name()) program = compileVariant(plan).trace;
        return program;
    }

private:
    std::map<std::string, GlProgram> programs_;
};

/// An atlas and a program on the device, which batches of rays stream through. `Record` says which precision:
/// QueryHit or QueryHitDouble.
template <class Record>
class BatchTracer {
public:
    BatchTracer(const GlContext& context, const Atlas& atlas, const QuerySettings& settings, bool scattered,
                std::size_t rayCount, ProgramCache& programs)
        : BatchTracer(context, atlas, settings, featuresFor(context, atlas, settings, scattered), rayCount,
                      programs) {}

    std::size_t batchSize() const { return gpuRays_.batchSize(); }

    /// At most batchSize() rays, one hit for each.
    void trace(std::span<const QueryRay> rays, std::span<Record> hits) {
        gpuAtlas_.bind();
        gpuRays_.upload(rays);
        gpuRays_.trace(program_, 1, software_);
        gpuRays_.readHits(std::as_writable_bytes(hits));
    }
    /// Leaves other hits in the device's memory, so that none of those wanted can be left over from before.
    void traceBackwards(std::span<const QueryRay> rays) {
        const std::vector<QueryRay> backwards(rays.rbegin(), rays.rend());
        gpuAtlas_.bind();
        gpuRays_.upload(std::span(backwards).first(std::min(rays.size(), batchSize())));
        gpuRays_.trace(program_, 1, software_);
    }

private:
    static SceneFeatures featuresFor(const GlContext& context, const Atlas& atlas,
                                     const QuerySettings& settings, bool scattered) {
        SceneFeatures features = queryFeatures(atlas, settings.anyHit);
        features.doublePrecision = std::is_same_v<Record, QueryHitDouble>;
        features.intersect = settings.intersect;
        features.scatteredRays = scattered;
        features.software = context.device().software;
        features.subgroups = scattered && context.limits().subgroups;
        return features;
    }
    BatchTracer(const GlContext& context, const Atlas& atlas, const QuerySettings& settings,
                const SceneFeatures& features, std::size_t rayCount, ProgramCache& programs)
        : BatchTracer(context, atlas, settings,
                      planResources(atlas, features, ShaderKind::Query,
                                    settings.limits.value_or(context.limits().resources), "atlas"),
                      rayCount, programs) {}
    BatchTracer(const GlContext& context, const Atlas& atlas, const QuerySettings& settings,
                const ResourcePlan& plan, std::size_t rayCount, ProgramCache& programs)
        : gpuAtlas_(uploadAtlas(atlas, plan, context.limits(), 0, "atlas", settings.pieceBytes)),
          gpuRays_(rayCount, plan.features, context.limits(), settings.maxBatch,
                   plan.features.subgroups ? std::nullopt : std::optional(3u)),
          program_(programs.of(plan)), software_(context.device().software) {}

    GpuAtlas gpuAtlas_;
    GpuRays gpuRays_;
    const GlProgram& program_;
    bool software_;
};

template <class Record>
std::vector<Record> traceVariant(const GlContext& context, const Atlas& atlas,
                                 const std::vector<QueryRay>& rays, const QuerySettings& settings,
                                 bool scattered) {
    ProgramCache programs;
    BatchTracer<Record> tracer(context, atlas, settings, scattered, rays.size(), programs);
    if (scattered) tracer.traceBackwards(rays);
    std::vector<Record> hits(rays.size());
    for (std::size_t first = 0; first < rays.size(); first += tracer.batchSize()) {
        const std::size_t count = std::min(tracer.batchSize(), rays.size() - first);
        tracer.trace(std::span(rays).subspan(first, count), std::span(hits).subspan(first, count));
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
