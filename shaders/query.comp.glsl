// Rays of a batch: raw rays in, raw hits out. One per invocation, or, where neighbours go different ways, each invocation
// takes another one as soon as enough of those that run side by side have done theirs (Aila & Laine 2009).
#include "formats/shared_types.shared.h"
#include "formats/atlas.shared.h"
#include "formats/gpu_interface.shared.h"
#include "shaders/features.glsl"
#include "shaders/resources.glsl"
#include "shaders/real.glsl"
#include "shaders/ray.glsl"
#include "shaders/intersect.glsl"
#include "shaders/traverse.glsl"
#include "shaders/lanes.glsl"
#include "shaders/walk.glsl"

layout(local_size_x = RT_GROUP_X, local_size_y = 1) in;

// False if there is no way to go: a direction that is zero, anything not finite, tMax before tMin.
bool isTraceable(QueryRay query) {
    vec3 size = abs(query.directionTmax.xyz);
    bool finite = all(lessThanEqual(size, vec3(3.4e38f))) && all(lessThanEqual(abs(query.originTmin.xyz), vec3(3.4e38f)));
    bool hasLength = query.originTmin.w <= query.directionTmax.w; // false for NaN
    return hasLength && finite && max(size.x, max(size.y, size.z)) > 0.0f;
}

// Largest power of two that is not above the largest component, as an exponent.
int scaleExponent(vec3 direction) {
    vec3 size = abs(direction);
    return int(floatBitsToUint(max(size.x, max(size.y, size.z))) >> 23) - 127;
}

// World to atlas space, and the direction to about unit size; both by powers of two, so nothing is rounded but the
// origin's offset. World t = atlas t * tScale.
Ray toAtlas(QueryRay query, out real tScale) {
    int exponent = scaleExponent(query.directionTmax.xyz);
    real directionScale = powerOfTwo(clamp(-exponent, -126, 127));
    tScale = directionScale / grid.worldOffset.w;
    real3 origin = (real3(query.originTmin.xyz) - grid.worldOffset.xyz) * grid.worldOffset.w;
    return Ray(origin, query.directionTmax.xyz * directionScale, max(query.originTmin.w, 0.0f) / tScale, min(query.directionTmax.w / tScale, real(3.4e38f)));
}

// t: of the hit, in world space.
#if RT_DOUBLE
#define HitRecord QueryHitDouble
const HitRecord kMiss = QueryHitDouble(-1.0LF, 0.0LF, 0.0LF, kNoTriangle, 0u);
HitRecord record(real t, Hit hit) {
    return QueryHitDouble(t, hit.u, hit.v, hit.triangle, 0u);
}
#else
#define HitRecord QueryHit
const HitRecord kMiss = QueryHit(uvec4(0xBF800000u, 0u, 0u, kNoTriangle)); // t = -1
HitRecord record(real t, Hit hit) {
    return QueryHit(uvec4(floatBitsToUint(vec3(t, hit.u, hit.v)), hit.triangle));
}
#endif

void count(uint index, WorkCounters work) {
#if RT_COUNT_WORK
    counters[index] = uvec4(work.rays, work.steps, work.tests, 0u);
#endif
}

#if RT_SCATTERED_RAYS
const uint kEnoughIdle = 20u; // of 32 lanes; measured
// Then another lane must go on: Mesa's software renderer, which has no subgroups, ends any loop after 65,535 rounds.
const uint kMostRaysPerLane = kSubgroups ? 0xFFFFFFFFu : 2u * kRaysPerLane;

// Whose turn it is. Lanes that ask together get neighbours.
uint takeRay() {
#if RT_SUBGROUPS
    uvec4 lanes = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) first = atomicAdd(nextRay, subgroupBallotBitCount(lanes));
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(lanes);
#else
    return atomicAdd(nextRay, 1u);
#endif
}

void main() {
    uint index = query.count.x; // of the ray that walks; none yet
    real tScale;
    real tEnter;
    Walk w;
    w.walking = false;
    w.entryAt = 0u;
    WorkCounters work;
    uint taken = 0u;
    for (bool more = true; more;) {
        bool refill = lanesWhere(!w.walking) * 32u >= lanesWhere(true) * kEnoughIdle;
        if (refill && !w.walking) {
            if (index < query.count.x) {
                hits[index] = w.best.triangle == kNoTriangle ? kMiss : record((w.best.t + tEnter) * tScale, w.best);
                count(index, work);
            }
            index = taken++ < kMostRaysPerLane ? takeRay() : query.count.x;
            more = index < query.count.x;
            if (more) {
                QueryRay next = rays[index];
                bool traceable = isTraceable(next);
                work = WorkCounters(traceable ? 1u : 0u, 0u, 0u);
                Ray ray = toAtlas(next, tScale);
                bool enters = enterGrid(ray, tEnter);
                w = beginWalk(ray);
                w.walking = traceable && enters;
            }
        }
        advance(w, kAnyHit, work);
    }
}
#else
void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(RT_GROUP_X) + gl_LocalInvocationID.x;
    if (index >= query.count.x) return;
    HitRecord result = kMiss;
    WorkCounters work = WorkCounters(0u, 0u, 0u);
    QueryRay next = rays[index];
    if (isTraceable(next)) {
        real tScale;
        Hit hit = trace(toAtlas(next, tScale), kAnyHit, work);
        if (hit.triangle != kNoTriangle) result = record(hit.t * tScale, hit);
    }
    hits[index] = result;
    count(index, work);
}
#endif
