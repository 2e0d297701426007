#include "tests/bench/embree_tracer.h"

#include "common/error.h"
#include "tests/support/embree_scene.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>

namespace rt::bench {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

QueryHit makeHit(float t, float u, float v, std::uint32_t triangle) {
    return {{std::bit_cast<std::uint32_t>(t), std::bit_cast<std::uint32_t>(u),
             std::bit_cast<std::uint32_t>(v), triangle}};
}

RTCRay toEmbree(const QueryRay& ray) {
    const glm::vec4& o = ray.originTmin;
    const glm::vec4& d = ray.directionTmax;
    return {o.x, o.y, o.z, o.w, d.x, d.y, d.z, 0.0f, d.w, ~0u, 0, 0};
}

QueryHit nearestHit(RTCScene scene, const QueryRay& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = toEmbree(ray);
    query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return makeHit(-1.0f, 0.0f, 0.0f, kNoTriangle);
    return makeHit(query.ray.tfar, query.hit.u, query.hit.v, query.hit.primID);
}

// Embree says whether something is hit, not what: t = 0 and triangle 0 stand for a hit.
QueryHit anyHitOf(RTCScene scene, const QueryRay& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = toEmbree(ray);
    rtcOccluded1(scene, &context, &query);
    return query.tfar < 0.0f ? makeHit(0.0f, 0.0f, 0.0f, 0) : makeHit(-1.0f, 0.0f, 0.0f, kNoTriangle);
}

constexpr std::size_t kPacket = 16;

void setRay(RTCRayHit16& packet, std::size_t i, const RTCRay& ray) {
    RTCRay16& r = packet.ray;
    r.org_x[i] = ray.org_x;
    r.org_y[i] = ray.org_y;
    r.org_z[i] = ray.org_z;
    r.dir_x[i] = ray.dir_x;
    r.dir_y[i] = ray.dir_y;
    r.dir_z[i] = ray.dir_z;
    r.tnear[i] = ray.tnear;
    r.tfar[i] = ray.tfar;
    r.time[i] = ray.time;
    r.mask[i] = ray.mask;
    r.flags[i] = r.id[i] = 0;
    packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

// Up to kPacket rays at once. The hits are only for Embree itself: nobody reads them.
void tracePacket(RTCScene scene, std::span<const QueryRay> rays, bool anyHit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) std::array<int, kPacket> valid{};
    alignas(64) RTCRayHit16 query;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        valid[i] = -1;
        setRay(query, i, toEmbree(rays[i]));
    }
    if (anyHit)
        rtcOccluded16(valid.data(), scene, &context, &query.ray);
    else
        rtcIntersect16(valid.data(), scene, &context, &query);
}

template <class F>
double medianPassMs(unsigned repeat, std::size_t count, F&& traceRange) {
    std::vector<double> passesMs;
    for (unsigned i = 0; i < repeat; ++i) {
        const Clock::time_point start = Clock::now();
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024),
                          [&](const auto& range) { traceRange(range.begin(), range.end()); });
        passesMs.push_back(msSince(start));
    }
    return medianOf(passesMs);
}

} // namespace

struct EmbreeTracer::Scene {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = nullptr;

    Scene() = default;
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;
    ~Scene() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

EmbreeTracer::EmbreeTracer(const Mesh& mesh, EmbreeMode mode, unsigned repeat)
    : scene_(std::make_unique<Scene>()) {
    std::vector<double> buildsMs;
    for (unsigned i = 0; i < repeat; ++i) {
        if (scene_->scene) rtcReleaseScene(scene_->scene);
        scene_->scene = test::newEmbreeScene(scene_->device, mesh);
        rtcSetSceneFlags(scene_->scene,
                         mode == EmbreeMode::Robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        const Clock::time_point start = Clock::now();
        rtcCommitScene(scene_->scene);
        buildsMs.push_back(msSince(start));
    }
    if (const RTCError error = rtcGetDeviceError(scene_->device); error != RTC_ERROR_NONE)
        throw Error(ErrorKind::Internal, fmt::format("Embree's build failed with its error {}", int(error)));
    buildMs_ = medianOf(buildsMs);
}

EmbreeTracer::~EmbreeTracer() = default;

EmbreeTracer::Traced EmbreeTracer::trace(std::span<const QueryRay> rays, bool anyHit, unsigned repeat) const {
    Traced traced;
    traced.hits.resize(rays.size());
    traced.passMs = medianPassMs(repeat, rays.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r)
            traced.hits[r] = anyHit ? anyHitOf(scene_->scene, rays[r]) : nearestHit(scene_->scene, rays[r]);
    });
    return traced;
}

double EmbreeTracer::packetPassMs(std::span<const QueryRay> rays, bool anyHit, unsigned repeat) const {
    return medianPassMs(repeat, rays.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; r += kPacket)
            tracePacket(scene_->scene, rays.subspan(r, std::min(kPacket, end - r)), anyHit);
    });
}

std::string EmbreeTracer::version() {
    return RTC_VERSION_STRING;
}

} // namespace rt::bench
